/// @file test_warp_emulated_memory.cpp
/// Memory of the emulated device that a Warper takes, beside what the plan of blocks states.
#include <gtest/gtest.h>

#include <cstddef>

#include <tetwarp/blocks.hpp>
#include <tetwarp/warp.hpp>

#include "kernels/exec/launch.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// With samples of one byte the lists of cells are a large part of all memory.
TEST(EmulatedMemory, IsWithinThePlan) {
  const Grid grid = scenes::unit_grid(128, 96, 96);
  const Mesh mesh = scenes::lattice({4, 3, 3}, {-8, -8, -8}, {136, 104, 104});
  const Volume source = scenes::wavy_volume(grid, PixelType::uint8);
  for (const bool has_classes : {true, false}) {
    WarpOptions options{.output_grid = grid, .backend = Backend::cuda};
    options.expert.skip.interior_cells = has_classes;
    const std::size_t before = simt::Device::only().allocated();
    Warper warper(source, mesh, options);
    std::vector<std::uint8_t> output(static_cast<std::size_t>(grid.voxel_count()));
    void* const volume = output.data();
    for (std::uint64_t step = 0; step < 3; ++step) {
      const std::vector<Point3> deformed = scenes::waved(mesh.rest_positions, 3, step);
      warper.step(deformed, {.volumes = std::span(&volume, 1)});

      // A packed source is made only where much memory is free, so no plan counts it.
      constexpr double packed_voxel = 4;
      const double packed =
          has_classes ? packed_voxel * static_cast<double>(grid.voxel_count()) : 0.0;
      const auto taken = static_cast<double>(simt::Device::only().allocated() - before) - packed;
      const BlockPlan plan =
          BlockPlanner(grid, mesh, options).plan(deformed, {.source_voxel = 1, .output_voxel = 1});
      ASSERT_EQ(plan.blocks.size(), 1u);
      EXPECT_LE(taken, plan.blocks.front().device_bytes);
      EXPECT_GE(taken, 0.8 * plan.blocks.front().device_bytes);
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

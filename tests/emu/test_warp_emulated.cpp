/// @file test_warp_emulated.cpp
/// Calls of a step to the emulated device: from the second step on one sequence of work, one wait
/// at its end, no allocation.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/scenes/skip_series.hpp"

#include "tests/emu/device_calls.hpp"

namespace tetwarp::test {
namespace {
WarpOptions on_device(bool updates = true) {
  WarpOptions options;
  options.backend = Backend::cuda;
  options.skip.unchanged_tets = updates;
  return options;
}

std::vector<Volume> sources_of(const scenes::Scene& scene) {
  return {scenes::wavy_volume(scene.source_grid, PixelType::int16),
          scenes::wavy_volume(scene.source_grid, PixelType::float32)};
}

/// All nodes move a little.
std::vector<Point3> shaken(const scenes::Scene& scene, int step) {
  return scenes::waved(scene.deformed, 0.1 * scene.output_grid.spacing[0],
                       static_cast<std::uint64_t>(step));
}

/// The host queues at least 15 calls, none of which allocates or releases, then waits; after the
/// first wait it only copies results to the host.
void expect_one_sequence(const DeviceCalls& calls) {
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0) << calls;
  EXPECT_EQ(calls.count(DeviceCall::release), 0) << calls;
  ASSERT_GT(calls.count(DeviceCall::wait), 0) << calls;
  EXPECT_GT(calls.first(DeviceCall::wait), 15) << calls;
  for (const DeviceCall work : {DeviceCall::launch, DeviceCall::fill, DeviceCall::copy_to_device,
                                DeviceCall::copy_within}) {
    EXPECT_LT(calls.last(work), calls.first(DeviceCall::wait)) << calls;
  }
}

TEST(WarpEmulated, StepsAfterTheFirstNeitherAllocateNorWaitInBetween) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const std::vector<Volume> sources = sources_of(scene);
  for (const bool updates : {true, false}) {
    for (const bool holds_previous : {true, false}) {
      Series series(sources, scene, on_device(updates));
      take_calls();
      series.step(scene.deformed, holds_previous);
      EXPECT_GT(take_calls().count(DeviceCall::allocate), 0);
      for (int step = 1; step < 6; ++step) {
        series.step(shaken(scene, step), holds_previous);

        expect_one_sequence(take_calls());
      }
    }
  }
}

/// Parts of the mesh move; every other target holds the step before the last.
TEST(WarpEmulated, UpdatesHaveTheBitsOfStepsFromScratch) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const std::vector<Volume> sources = sources_of(scene);
  Series updated(sources, scene, on_device()), anew(sources, scene, on_device(false));
  std::int64_t unchanged_cells = 0;
  for (const auto& positions : partial_motions(scene, 61)) {
    unchanged_cells += updated.step(positions).cells_unchanged;
    anew.step(positions);

    EXPECT_TRUE(updated.has_bits_of(anew));
    updated.swap_targets();
  }
  EXPECT_GT(unchanged_cells, 0);
}

/// Outputs in device memory are not copied to the host; only the counters are.
TEST(WarpEmulated, OutputsOnTheDeviceCostOneSmallCopy) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  WarpOptions options = on_device();
  options.output_grid = scene.output_grid;
  Warper warper(source, scene.mesh, options);
  float* output = nullptr;
  cudaMalloc(&output, static_cast<std::size_t>(scene.output_grid.voxel_count()) * sizeof(float));
  void* const volume = output;
  const WarpTarget target = {
      .volumes = std::span(&volume, 1), .memory = Memory::device, .holds_previous = true};
  warper.step(scene.deformed, target);
  for (int step = 1; step < 4; ++step) {
    take_calls();
    warper.step(shaken(scene, step), target);

    const DeviceCalls calls = take_calls();
    expect_one_sequence(calls);
    EXPECT_EQ(calls.count(DeviceCall::copy_to_host), 1) << calls;
  }
  cudaFree(output);
}

TEST(WarpEmulated, AStepWithoutRoomRunsAgainWithMore) {
  const scenes::Scene scene = scenes::adversarial_scene("tiny", 24);
  const std::vector<Volume> sources = sources_of(scene);
  Series series(sources, scene, on_device()), anew(sources, scene, on_device(false));
  std::vector<Point3> small = scene.deformed;
  for (Point3& p : small) {
    for (double& x : p) x *= 0.1;
  }
  series.step(small);
  take_calls();

  series.step(scene.deformed);
  const DeviceCalls calls = take_calls();
  anew.step(scene.deformed);

  EXPECT_GT(calls.count(DeviceCall::allocate), 0) << calls;
  EXPECT_TRUE(series.has_bits_of(anew));
}
}  // namespace
}  // namespace tetwarp::test

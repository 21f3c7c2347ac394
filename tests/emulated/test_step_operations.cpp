/// @file test_step_operations.cpp
/// Number of operations that a step gives to the device, at the size of the torso benchmark:
/// 256x160x122 voxels and 700 tetrahedra.
#include <gtest/gtest.h>

#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/warp.hpp>

#include "tests/emulated/device_calls.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// A Warper whose output stays on the device.
class ResidentSeries {
 public:
  explicit ResidentSeries(bool has_classes)
      : grid_(scenes::unit_grid(128, 80, 61)),
        source_(scenes::wavy_volume(grid_, PixelType::float32)),
        mesh_(scenes::lattice({7, 5, 4}, {4, 4, 4}, {124, 76, 57})),
        warper_(source_, mesh_, options(grid_, has_classes)) {
    cudaMalloc(&output_, static_cast<std::size_t>(grid_.voxel_count()) * sizeof(float));
  }
  ResidentSeries(const ResidentSeries&) = delete;
  ResidentSeries& operator=(const ResidentSeries&) = delete;
  ~ResidentSeries() { cudaFree(output_); }

  /// The calls of a step to these positions.
  DeviceCalls step(const std::vector<Point3>& deformed) {
    void* const volume = output_;
    take_calls();
    warper_.step(
        deformed,
        {.volumes = std::span(&volume, 1), .memory = Memory::device, .holds_previous = true});
    return take_calls();
  }
  std::vector<Point3> waved(std::uint64_t seed) const {
    return scenes::waved(mesh_.rest_positions, 3, seed);
  }
  std::size_t tet_count() const { return mesh_.tets.size(); }

 private:
  static WarpOptions options(const Grid& grid, bool has_classes) {
    WarpOptions options{.output_grid = grid, .backend = Backend::cuda};
    options.expert.skip.interior_cells = has_classes;
    return options;
  }

  Grid grid_;
  Volume source_;
  Mesh mesh_;
  Warper warper_;
  float* output_ = nullptr;
};

/// One graph launch, without memory operations, waits between or records of events.
void expect_one_graph(const DeviceCalls& calls, std::int64_t most) {
  EXPECT_EQ(calls.count(DeviceCall::graph), 1) << calls;
  EXPECT_EQ(calls.operations(), calls.count(DeviceCall::launch)) << calls;
  EXPECT_LE(calls.operations(), most) << calls;
  EXPECT_EQ(calls.count(DeviceCall::wait), 1) << calls;
}

/// A step of at most `most` operations, then steps in which little has moved, which are updates.
void expect_few_operations(bool has_classes, std::int64_t most, std::int64_t most_of_update) {
  ResidentSeries series(has_classes);
  ASSERT_EQ(series.tet_count(), 700);
  series.step(series.waved(1));
  series.step(series.waved(2));
  std::vector<Point3> some = series.waved(3);

  expect_one_graph(series.step(some), most);
  for (int step = 0; step < 3; ++step) {
    for (std::size_t n = 0; n < 20; ++n) some[n][0] += 0.5;
    const DeviceCalls calls = series.step(some);
    if (step > 0) expect_one_graph(calls, most_of_update);
  }
}

TEST(StepOperations, AreAtMostTen) {
  expect_few_operations(true, 10, 11);
}
TEST(StepOperations, AreFewerWithoutCellClasses) {
  expect_few_operations(false, 8, 10);
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_warp_emulated.cpp
/// Calls of a step to the emulated device: from the second step on one sequence of work, one wait
/// at its end, no allocation.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include <tetwarp/error.hpp>

#include "tests/support/skip_series.hpp"

#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
WarpOptions on_device(bool updates = true, bool masks = false) {
  WarpOptions options;
  options.backend = Backend::cuda;
  options.expert.skip.unchanged_tets = updates;
  options.expert.skip.grid_point_masks = masks;
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

/// The host queues a step's launches as one graph, allocates and releases nothing, then waits;
/// after the first wait it only copies results to the host.
void expect_one_sequence(const DeviceCalls& calls) {
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0) << calls;
  EXPECT_EQ(calls.count(DeviceCall::release), 0) << calls;
  ASSERT_GT(calls.count(DeviceCall::wait), 0) << calls;
  EXPECT_EQ(calls.count(DeviceCall::graph), 1) << calls;
  EXPECT_EQ(calls.first(DeviceCall::graph), 0) << calls;
  EXPECT_GT(calls.first(DeviceCall::wait), 8) << calls;
  for (const DeviceCall work : {DeviceCall::launch, DeviceCall::fill, DeviceCall::copy_to_device,
                                DeviceCall::copy_within}) {
    EXPECT_LT(calls.last(work), calls.first(DeviceCall::wait)) << calls;
  }
}

TEST(WarpEmulated, StepsAfterTheFirstNeitherAllocateNorWaitInBetween) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const std::vector<Volume> sources = sources_of(scene);
  for (const int way : {0, 1, 2, 3, 4, 5, 6, 7}) {
    const bool updates = (way & 1) != 0, holds_previous = (way & 2) != 0, masks = (way & 4) != 0;
    Series series(sources, scene, on_device(updates, masks));
    take_calls();
    series.step(scene.deformed, holds_previous);
    EXPECT_GT(take_calls().count(DeviceCall::allocate), 0);
    for (int step = 1; step < 6; ++step) {
      series.step(shaken(scene, step), holds_previous);

      expect_one_sequence(take_calls());
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

/// The last kernel writes the counters to memory of the host.
TEST(WarpEmulated, OutputsOnTheDeviceCostNoCopy) {
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
    EXPECT_EQ(calls.count(DeviceCall::copy_to_host), 0) << calls;
  }
  cudaFree(output);
}

TEST(WarpEmulated, AStepWithoutRoomRunsAgainWithMore) {
  const scenes::Scene scene = scenes::adversarial_scene("tiny", 13);
  const std::vector<Volume> sources = sources_of(scene);
  std::vector<Point3> small = scene.deformed;
  for (Point3& p : small) {
    for (double& x : p) x *= 0.1;
  }
  for (const bool masks : {false, true}) {
    Series series(sources, scene, on_device(true, masks)), anew(sources, scene, on_device(false));
    series.step(small);
    take_calls();

    series.step(scene.deformed);
    const DeviceCalls calls = take_calls();
    anew.step(scene.deformed);

    EXPECT_GT(calls.count(DeviceCall::allocate), 0) << calls;
    EXPECT_TRUE(series.has_bits_of(anew));
  }
}

/// The step whose allocation fails needs larger lists.
TEST(LongWarpEmulated, AStepAfterAFailedAllocationIsRight) {
  const scenes::Scene scene = scenes::adversarial_scene("tiny", 16);
  const std::vector<Volume> sources = sources_of(scene);
  Series anew(sources, scene, on_device(false));
  anew.step(scene.deformed);
  std::vector<Point3> small = scene.deformed;
  for (Point3& p : small) {
    for (double& x : p) x *= 0.1;
  }
  int failures = 0;
  for (bool fails = true; fails; ++failures) {
    Series series(sources, scene, on_device());
    series.step(small);
    simt::Device::only().failing_allocation = failures;
    try {
      series.step(scene.deformed);
      fails = false;
    } catch (const CudaError&) {
    }
    simt::Device::only().failing_allocation = simt::Device::none;

    series.step(scene.deformed);

    EXPECT_TRUE(series.has_bits_of(anew)) << "allocation " << failures;
  }
  EXPECT_GT(failures, 3);
}

/// Updates and steps from scratch, into two targets in no regular order: more combinations than
/// graphs are kept, whose arguments are therefore replaced.
TEST(WarpEmulated, GraphsFollowTheStepsArguments) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  const std::vector<Volume> sources = sources_of(scene);
  Series first(sources, scene, on_device()), anew(sources, scene, on_device(false));
  const std::vector<std::vector<Point3>> motions = partial_motions(scene, 5);
  for (std::size_t s = 0; s < motions.size(); ++s) {
    const bool holds_previous = s % 3 != 0;
    first.step(motions[s], holds_previous);
    anew.step(motions[s], false);

    EXPECT_TRUE(first.has_bits_of(anew)) << "step " << s;
    if (s % 4 == 1) first.swap_targets();
    if (s % 5 == 2) anew.swap_targets();
  }
}

/// Interior cells by their own kernel or as all others: with updates, masks and owners.
TEST(WarpEmulated, InteriorCellsHaveTheBitsOfOtherCells) {
  scenes::Scene scene = scenes::adversarial_scene("identity", 48);
  scene.mesh = scenes::lattice({1, 1, 1}, {-0.5, -0.5, -0.5}, {47.5, 44.5, 49.5});
  scene.deformed = scenes::waved(scene.mesh.rest_positions, 3.0, 11);
  const std::vector<Volume> sources = sources_of(scene);
  WarpOptions plain = on_device();
  plain.expert.skip.interior_cells = false;
  Series lean(sources, scene, on_device()), all(sources, scene, plain);
  for (int step = 0; step < 3; ++step) {
    const Counts by_class = lean.step(shaken(scene, step));
    const Counts general = all.step(shaken(scene, step));

    EXPECT_TRUE(lean.has_bits_of(all));
    EXPECT_EQ(by_class.covered, general.covered);
  }
}
}  // namespace
}  // namespace tetwarp::test

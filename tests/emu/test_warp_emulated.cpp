/// @file test_warp_emulated.cpp
/// What a step asks of the device, on an emulated one: from the second step on one sequence of
/// work, one wait at its end, no allocation.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/scenes/skip_series.hpp"

#include "kernels/exec/launch.hpp"

namespace tetwarp::test {
namespace {

scenes::Scene scene_named(const std::string& name) {
  for (const scenes::Scene& scene : scenes::adversarial_scenes(24)) {
    if (scene.name == name) return scene;
  }
  throw std::invalid_argument("no scene " + name);
}

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

/// Letters of the calls that the host made, see simt::ApiCall.
std::string take_calls() {
  return simt::Device::only().take_calls();
}

void expect_one_sequence(const std::string& calls) {
  const std::size_t wait = calls.find('W');
  ASSERT_NE(wait, std::string::npos);
  EXPECT_EQ(calls.find_first_of("AF"), std::string::npos) << calls;
  EXPECT_EQ(calls.find_first_of("LZUC", wait), std::string::npos) << calls;
  EXPECT_GT(wait, 15u) << calls;
}

TEST(WarpEmulated, StepsAfterTheFirstNeitherAllocateNorWaitInBetween) {
  const scenes::Scene scene = scene_named("waved");
  const std::vector<Volume> sources = sources_of(scene);
  for (const bool updates : {true, false}) {
    for (const bool holds_previous : {true, false}) {
      Series series(sources, scene, on_device(updates));
      take_calls();
      series.step(scene.deformed, holds_previous);
      EXPECT_NE(take_calls().find('A'), std::string::npos);
      for (int step = 1; step < 6; ++step) {
        series.step(shaken(scene, step), holds_previous);

        expect_one_sequence(take_calls());
      }
    }
  }
}

/// Parts of the mesh move; every other target holds the step before the last.
TEST(WarpEmulated, UpdatesHaveTheBitsOfStepsFromScratch) {
  const scenes::Scene scene = scene_named("waved");
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

/// What the device writes for others stays there: all that comes home are the counters.
TEST(WarpEmulated, OutputsOnTheDeviceCostOneSmallCopy) {
  const scenes::Scene scene = scene_named("waved");
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

    const std::string calls = take_calls();
    expect_one_sequence(calls);
    EXPECT_EQ(std::ranges::count(calls, 'D'), 1) << calls;
  }
  cudaFree(output);
}

TEST(WarpEmulated, AStepWithoutRoomRunsAgainWithMore) {
  const scenes::Scene scene = scene_named("tiny");
  const std::vector<Volume> sources = sources_of(scene);
  Series series(sources, scene, on_device()), anew(sources, scene, on_device(false));
  std::vector<Point3> small = scene.deformed;
  for (Point3& p : small) {
    for (double& x : p) x *= 0.1;
  }
  series.step(small);
  take_calls();

  series.step(scene.deformed);
  const std::string calls = take_calls();
  anew.step(scene.deformed);

  EXPECT_NE(calls.find('A'), std::string::npos);
  EXPECT_TRUE(series.has_bits_of(anew));
}

}  // namespace
}  // namespace tetwarp::test

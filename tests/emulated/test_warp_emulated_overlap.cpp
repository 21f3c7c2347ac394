/// @file test_warp_emulated_overlap.cpp
/// Steps in flight on the emulated device: any order of events that CUDA allows gives the same
/// bits, and leaving out a wait changes them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "kernels/exec/staging_ring.cuh"
#include "tests/support/skip_series.hpp"
#include "tests/support/steps_in_flight.hpp"

#include "tests/emulated/device_calls.hpp"

namespace tetwarp::test {
namespace {
/// The streams of the only Warper, in the order of their creation.
enum StreamNumber { compute_stream, upload_stream, download_stream };

class EmulatedOverlap : public ::testing::Test {
 protected:
  const scenes::Scene scene = scenes::adversarial_scene("identity", 16);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::int16),
                                       scenes::wavy_volume(scene.source_grid, PixelType::float32)};
  const WarpOptions options = {.backend = Backend::cuda};
  simt::Device& device = simt::Device::only();

  void TearDown() override { device.eager_stream = device.skipped_wait = device.none; }

  /// All nodes move, so that every step is a whole one.
  Steps shaken(std::uint64_t count) const {
    Steps steps;
    for (std::uint64_t step = 0; step < count; ++step) {
      steps.push_back(scenes::waved(scene.deformed, 0.3 * scene.output_grid.spacing[0], step));
    }
    return steps;
  }
};

TEST_F(EmulatedOverlap, AnyStreamMayRunAheadOfTheOthers) {
  const Steps steps = partial_motions(scene, 72);
  const std::vector<Bits> expected = steps_one_by_one(sources, scene, options, steps);

  for (const int ahead : {device.none, +compute_stream, +upload_stream, +download_stream}) {
    for (const Pages pages : {Pages::locked, Pages::pageable}) {
      for (const bool holds_previous : {true, false}) {
        device.eager_stream = ahead;
        EXPECT_TRUE(steps_in_flight(sources, scene, options, steps, pages, holds_previous) ==
                    expected)
            << "stream " << ahead;
      }
    }
  }
}

/// A step waits for its positions, if there are more than kernels read from memory of the host, and
/// its downloads wait for its kernels.
TEST_F(EmulatedOverlap, LeavingOutAWaitChangesTheResult) {
  constexpr int waits_of_step = 2;
  scenes::Scene large = scene;
  large.mesh.rest_positions.resize(3000, scene.mesh.rest_positions.back());
  large.deformed.resize(3000, scene.deformed.back());
  Steps steps;
  for (std::uint64_t step = 0; step < 5; ++step) {
    steps.push_back(scenes::waved(large.deformed, 0.3 * scene.output_grid.spacing[0], step));
  }
  const std::vector<Bits> expected = steps_one_by_one(sources, large, options, steps);
  const auto run = [&](int ahead, int skipped) {
    device.eager_stream = ahead;
    device.skipped_wait = skipped;
    return steps_in_flight(sources, large, options, steps, Pages::locked, false);
  };

  for (int step = 2; step < 5; ++step) {
    const int first = waits_of_step * step;
    EXPECT_FALSE(run(compute_stream, first) == expected) << "positions of step " << step;
    EXPECT_EQ(device.skipped_wait, device.none);
    EXPECT_FALSE(run(download_stream, first + 1) == expected) << "kernels of step " << step;
    EXPECT_TRUE(run(download_stream, device.none) == expected);
  }
}

/// The host waits for the kernels of the step before and for nothing else, and does not allocate.
TEST_F(EmulatedOverlap, KernelsAreLaunchedBeforeTheLastStepIsDownloaded) {
  const Steps steps = shaken(6);
  const StepBuffers buffers[] = {{sources, scene.output_grid, Pages::locked},
                                 {sources, scene.output_grid, Pages::locked}};
  Warper warper = make_warper(sources, scene, options);
  for (std::size_t s = 0; s < steps.size(); ++s) {
    if (s > 2) take_calls();
    const Bits before = buffers[(s + 1) % 2].bits();

    warper.begin_step(steps[s], buffers[s % 2].target(false));

    const DeviceCalls calls = take_calls();
    if (s > 2) {
      EXPECT_EQ(calls.count(DeviceCall::allocate), 0) << calls;
      EXPECT_EQ(calls.count(DeviceCall::release), 0) << calls;
      EXPECT_EQ(calls.count(DeviceCall::wait), 1) << calls;
      EXPECT_EQ(calls.count(DeviceCall::copy_to_device), 0) << calls;
      EXPECT_LT(calls.first(DeviceCall::wait), calls.first(DeviceCall::launch)) << calls;
      EXPECT_EQ(calls.count(DeviceCall::copy_to_host), 6) << calls;  // one per output
    }
    if (s == 0) continue;
    EXPECT_TRUE(buffers[(s + 1) % 2].bits() == before) << "the step before is downloaded already";
    warper.finish_step();
    EXPECT_FALSE(buffers[(s + 1) % 2].bits() == before);
  }
}

/// Results and sources large enough for the ring of page-locked memory.
class EmulatedStagedSteps : public EmulatedOverlap {
 protected:
  const scenes::Scene large = scenes::adversarial_scene("waved", 40);
  const std::vector<Volume> tensors = {
      scenes::wavy_volume(large.source_grid, PixelType::float64, 9)};

  void SetUp() override { ASSERT_GE(tensors[0].data.size(), StagingRing::least_bytes); }
};

TEST_F(EmulatedStagedSteps, HaveTheBitsOfTheCpuWhicheverStreamRunsAhead) {
  const Steps steps = {large.deformed, scenes::waved(large.deformed, 0.5, 1),
                       scenes::waved(large.deformed, 0.5, 2)};
  const std::vector<Bits> expected =
      steps_one_by_one(tensors, large, {.backend = Backend::cpu}, steps);

  for (const int ahead : {device.none, +compute_stream, +upload_stream, +download_stream}) {
    device.eager_stream = ahead;
    EXPECT_TRUE(steps_in_flight(tensors, large, options, steps, Pages::pageable, true) == expected)
        << "stream " << ahead;
  }
}

/// While the host empties the ring of one step, the device has the kernels of the next.
TEST_F(EmulatedStagedSteps, AreDownloadedAfterTheLaunchesOfTheNextStep) {
  const StepBuffers buffers[] = {{tensors, large.output_grid, Pages::pageable},
                                 {tensors, large.output_grid, Pages::pageable}};
  Warper warper = make_warper(tensors, large, options);
  for (std::size_t s = 0; s < 5; ++s) {
    take_calls();

    warper.begin_step(scenes::waved(large.deformed, 0.5, s), buffers[s % 2].target(false));

    const DeviceCalls calls = take_calls();
    if (s == 0) continue;
    EXPECT_GT(calls.first(DeviceCall::copy_to_host), calls.last(DeviceCall::launch)) << calls;
    EXPECT_GT(calls.count(DeviceCall::copy_to_host), 5 + 2) << calls;  // several of the volume
    if (s > 2) {
      EXPECT_EQ(calls.count(DeviceCall::allocate), 0) << calls;
    }
    warper.finish_step();
    EXPECT_EQ(take_calls().count(DeviceCall::copy_to_host), 0);
  }
}

/// Every span of work takes a millisecond here, so that times count spans.
TEST_F(EmulatedOverlap, AFailedStepIsNotChargedToTheNext) {
  const Steps steps = shaken(2);
  std::vector<Point3> bad = steps[0];
  bad.front()[0] = 1e300;
  const StepBuffers buffer(sources, scene.output_grid, Pages::locked);
  WarpOptions anew = options;
  anew.expert.skip.unchanged_tets = false;
  anew.stage_times = true;
  Warper warper = make_warper(sources, scene, anew);
  warper.step(steps[0], buffer.target(false));
  const Timings expected = warper.step(steps[1], buffer.target(false)).timings;

  EXPECT_THROW(warper.step(bad, buffer.target(false)), std::invalid_argument);
  const Timings timings = warper.step(steps[1], buffer.target(false)).timings;

  EXPECT_EQ(timings.upload, expected.upload);
  EXPECT_EQ(timings.setup, expected.setup);
  EXPECT_EQ(timings.raster, expected.raster);
}
}  // namespace
}  // namespace tetwarp::test

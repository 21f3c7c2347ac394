/// @file test_backend_choice_emulated.cpp
/// Backend::automatic where a device is usable: cpu for less work than the device's start takes.
#include <gtest/gtest.h>

#include <tetwarp/warp.hpp>

#include "host/warp/backend_choice.hpp"
#include "host/warp/device_start.hpp"
#include "tests/emulated/device_calls.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// The device as a new process finds it.
class AutomaticBackend : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(simt::Device::only().allocated(), 0u);
    take_calls();
  }

  Volume source_ = scenes::wavy_volume(scenes::unit_grid(8, 8, 8), PixelType::uint8);
  Mesh mesh_ = scenes::lattice({1, 1, 1}, {-1, -1, -1}, {8, 8, 8});
};

TEST_F(AutomaticBackend, LeavesOneSmallWarpToTheCpuAndTheDeviceAlone) {
  const WarpResult result = warp(source_, mesh_, mesh_.rest_positions);

  EXPECT_EQ(result.report.backend, Backend::cpu);
  EXPECT_EQ(result.report.backend_reason,
            "the work is less than what a CUDA device takes to start");
  EXPECT_EQ(take_calls(), DeviceCalls(""));
}

TEST_F(AutomaticBackend, TakesTheDeviceForAWarpThatTakesLonger) {
  // 8 x 95 ns for each of 66^3 voxels: 0.22 s.
  WarpOptions options{.filter = Filter::lanczos,
                      .antialias = true,
                      .output_grid = scenes::unit_grid(66, 66, 66),
                      .threads = 1};
  EXPECT_EQ(warp(source_, mesh_, mesh_.rest_positions, options).report.backend, Backend::cuda);
  options.threads = 2;
  EXPECT_EQ(warp(source_, mesh_, mesh_.rest_positions, options).report.backend, Backend::cpu);
}

TEST_F(AutomaticBackend, OfAWarperIsTheDeviceAsItsStepsAreUnknown) {
  const Warper warper(source_, mesh_);

  EXPECT_EQ(warper.report().backend, Backend::cuda);
}

TEST_F(AutomaticBackend, TakesADeviceThatHasStarted) {
  const Warper other(source_, mesh_, {.backend = Backend::cuda});

  const WarpResult result = warp(source_, mesh_, mesh_.rest_positions);

  EXPECT_EQ(result.report.backend, Backend::cuda);
  EXPECT_EQ(result.report.backend_reason, "emulation is usable");
}

TEST_F(AutomaticBackend, ComparesSecondsWithTheStart) {
  const auto chosen = [](double seconds, Backend requested, int device = 0) {
    return choose_backend_for(seconds, {.backend = requested, .device = device}).first;
  };

  EXPECT_EQ(chosen(0.99 * device_start_seconds, Backend::automatic), Backend::cpu);
  EXPECT_EQ(chosen(1.01 * device_start_seconds, Backend::automatic), Backend::cuda);
  EXPECT_EQ(chosen(1, Backend::automatic, 1), Backend::cpu);  // there is no device 1
  EXPECT_EQ(chosen(0, Backend::cuda), Backend::cuda);
  EXPECT_EQ(chosen(0, Backend::reference), Backend::reference);
}
}  // namespace
}  // namespace tetwarp::test

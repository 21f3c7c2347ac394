/// @file test_detection_copies_emulated.cpp
/// What a step with contact on back end cuda copies between host and device.
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/emu/device_calls.hpp"
#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Four rows of four bricks, each on two below it.
Scene brick_wall() {
  std::vector<Body> bricks;
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k < 4; ++k) {
      const double x = 0.061 * k + (row % 2) * 0.03, z = 0.0153 + 0.0303 * row;
      bricks.push_back(rigid_box("brick" + std::to_string(4 * row + k), {0.03, 0.02, 0.015}, {x, 0, z}));
    }
  }
  Scene scene = scene_of(bricks, 0.004);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.contact.material.friction = 0.4;
  return scene;
}

TEST(DetectionCopies, Measure) {
  Simulator simulator(brick_wall(), {.backend = Backend::cuda, .threads = 1});
  run(simulator, 10);
  for (int k = 0; k < 3; ++k) {
    take_copied();
    take_calls();
    simulator.step();
    const simt::CopiedBytes copied = take_copied();
    const DeviceCalls calls = take_calls();
    const StepRecord& record = simulator.record();
    std::printf("contacts %d passes %d up %zu down %zu calls U %d D %d L %d\n", int(record.contacts),
                int(record.contact_passes), copied.to_device, copied.to_host,
                int(calls.count(DeviceCall::copy_to_device)),
                int(calls.count(DeviceCall::copy_to_host)), int(calls.count(DeviceCall::launch)));
  }
}

}  // namespace
}  // namespace tetwarp::test

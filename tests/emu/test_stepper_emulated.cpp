/// @file test_stepper_emulated.cpp
/// What the stepper of back end cuda asks of a device; the emulated one records it.
#include <gtest/gtest.h>

#include "tests/emu/device_calls.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
/// An elastic block with a held node, and a rigid body tied to it.
Model small_block() {
  Model model = empty_model();
  const std::int32_t block = add_block(model, {.cells = {2, 2, 2}, .gamma = 1e-3});
  model.prescribed[0] = 1;
  const std::int32_t rigid = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_spring(model, rigid_point(model, rigid, {0.1, 0.02, 0}), node_point(model, block + 3), 500,
             2);
  return model;
}

TEST(StepperEmulated, AStepAllocatesNothing) {
  const Model model = small_block();
  const auto stepper = make_cuda_stepper(model, {});
  stepper->step(input_for(model, 5e-3));
  take_calls();

  stepper->step(input_for(model, 5e-3));

  const DeviceCalls calls = take_calls();
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0);
  EXPECT_EQ(calls.count(DeviceCall::release), 0);
  EXPECT_LT(calls.count(DeviceCall::launch), 30);
}

TEST(StepperEmulated, PositionsAreInDeviceMemory) {
  const Model model = small_block();
  const auto stepper = make_cuda_stepper(model, {});

  const PositionsView view = stepper->positions(3, 5);

  EXPECT_EQ(view.memory, Memory::device);
  EXPECT_EQ(view.node_count, 5);
  EXPECT_TRUE(simt::Device::only().is_on_device(view.xyz, 15 * sizeof(double)));
}

}  // namespace
}  // namespace tetwarp::test

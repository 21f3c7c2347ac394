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

/// An island of more than 1024 rows: eight iterations are one launch and one read once the first
/// eight have been made and recorded.
TEST(StepperEmulated, LargeIslandsIterateAsGraphs) {
  Model model = empty_model();
  add_block(model, {.cells = {10, 9, 10}, .youngs = 1e7});
  model.prescribed[0] = 1;
  StepperOptions options;
  options.linear_tolerance = 1e-10;
  const auto stepper = make_cuda_stepper(model, options);
  const StepInput input = input_for(model, 5e-3, {0, 0, -9.81});
  stepper->step(input);
  take_calls();

  const StepOutcome outcome = stepper->step(input);

  const DeviceCalls calls = take_calls();
  ASSERT_TRUE(outcome.converged);
  ASSERT_GE(outcome.linear_iterations, 48);
  EXPECT_GE(calls.count(DeviceCall::graph), outcome.linear_iterations / 8 - 2);
  EXPECT_LT(calls.count(DeviceCall::copy_to_host), 10 + outcome.linear_iterations / 8);
  EXPECT_EQ(calls.count(DeviceCall::allocate), 0);
}

/// A number of iterations that is no multiple of eight ends with single ones.
TEST(StepperEmulated, LargeIslandsKeepTheLimitOfIterations) {
  Model model = empty_model();
  add_block(model, {.cells = {10, 9, 10}});
  model.prescribed[0] = 1;
  StepperOptions options;
  options.linear_tolerance = 1e-14;
  options.max_iterations = 21;
  const auto cuda = make_cuda_stepper(model, options), cpu = make_cpu_stepper(model, options);
  const StepInput input = input_for(model, 5e-3, {0, 0, -9.81});

  const StepOutcome outcome = cuda->step(input);
  cpu->step(input);

  EXPECT_EQ(outcome.linear_iterations, 21);
  EXPECT_FALSE(outcome.converged);
  const ModelState a = state_of(*cuda), b = state_of(*cpu);
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    EXPECT_LT(distance(a.velocity[i], b.velocity[i]), 1e-9);
  }
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

/// @file test_stepper_parity.cpp
/// The stepper of back end cuda against that of cpu, on a device where there is one, and on the
/// emulated one. Stages have equal bits; sums of conjugate gradients are in another order, so
/// velocities agree to the tolerance.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include <tetwarp/error.hpp>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
StepperOptions exact() {
  StepperOptions options;
  options.linear_tolerance = 1e-13;
  return options;
}

/// Elastic, rigid and cloth bodies with springs between them, held nodes, a handle.
Model mixed_model(std::array<int, 3> cells) {
  Model model = empty_model();
  const std::int32_t block = add_block(model, {.cells = cells, .gamma = 1e-3});
  model.prescribed[0] = model.prescribed[1] = 1;
  const std::int32_t sheet = add_sheet(model, 4, 0.1, 100, 0.1);
  const std::int32_t rigid = add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-0.2, 0.1, 0.1});
  add_rigid(model, 0.5, {1e-3, 2e-3, 2e-3}, {-2, 0.1, 0.1});
  add_spring(model, rigid_point(model, rigid, {0.1, 0.02, 0}), node_point(model, block + 3), 500,
             2);
  add_spring(model, node_point(model, sheet), world_point({0, 0, 0}), 300, 1);
  model.springs.handle.back() = 0;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.3);
  for (Point3& v : model.start.velocity) v = {normal(random), normal(random), normal(random)};
  model.start.angular_momentum = {{1e-3, 2e-3, -1e-3}, {0, 3e-3, 1e-3}};
  return model;
}

void expect_parity(const Model& model, const StepperOptions& options, int steps) {
  std::unique_ptr<BodyStepper> cuda;
  try {
    cuda = make_cuda_stepper(model, options);
  } catch (const CudaError& error) {
    GTEST_SKIP() << error.what();
  }
  const auto cpu = make_cpu_stepper(model, options);
  StepInput input = input_for(model, 5e-3, {0, 0, -9.81});
  input.prescribed_velocity[0] = {0.1, 0, 0};
  input.anchor.back() = {0, 0, 0.2};
  for (int n = 0; n < steps; ++n) {
    const StepOutcome a = cpu->step(input), b = cuda->step(input);

    EXPECT_TRUE(a.converged && b.converged);
    EXPECT_LE(std::abs(a.linear_iterations - b.linear_iterations), 9);
    EXPECT_EQ(a.skipped_rotations, b.skipped_rotations);
    EXPECT_EQ(a.skipped_blocks, b.skipped_blocks);
    const ModelState one = state_of(*cpu), other = state_of(*cuda);
    for (std::size_t i = 0; i < one.velocity.size(); ++i) {
      EXPECT_LT(distance(one.velocity[i], other.velocity[i]), 1e-10);
    }
    for (std::size_t i = 0; i < one.position.size(); ++i) {
      EXPECT_LT(distance(one.position[i], other.position[i]), 1e-12);
    }
    const auto supports = cpu->support_impulses(), other_supports = cuda->support_impulses();
    for (std::size_t i = 0; i < supports.size(); ++i) {
      EXPECT_LT(distance(supports[i], other_supports[i]), 1e-10);
    }
  }
}

/// Each island is solved by one block in one launch.
TEST(StepperParity, SmallIslandsAgreeWithTheCpu) {
  expect_parity(mixed_model({2, 2, 2}), exact(), 3);
}

/// An island of more than 1024 rows takes the whole device.
TEST(StepperParity, LargeIslandsAgreeWithTheCpu) {
  expect_parity(mixed_model({10, 9, 10}), exact(), 1);
}

TEST(StepperParity, Float32SolvesAgreeWithTheCpu) {
  StepperOptions options = exact();
  options.linear_tolerance = 1e-12;
  options.float32_solve = true;
  expect_parity(mixed_model({2, 2, 2}), options, 2);
}

}  // namespace
}  // namespace tetwarp::test

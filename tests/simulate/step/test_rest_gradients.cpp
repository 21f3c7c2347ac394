/// Linear solves of elastic bodies by their factors at rest. Solves in float32 do without them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {

constexpr std::int64_t without = 3;  // iterations by block Jacobi alone, before the factors

/// A stiff block of which the nodes of one face are held, turned by 2 rad, and a free one.
Model stiff_model(double flattened = 1) {
  Model model = empty_model();
  add_block(model, {.cells = {6, 3, 3}, .jitter = 0.2, .youngs = 1e8});
  const std::int32_t free =
      add_block(model, {.cells = {4, 4, 4}, .origin = {2, 0, 0}, .youngs = 1e8});
  for (std::int32_t n = 0; n < free; n += 7) model.prescribed[static_cast<std::size_t>(n)] = 1;
  for (std::size_t n = 0; n < model.start.position.size(); ++n) {
    Point3& x = model.start.position[n];
    x = {std::cos(2.0) * x[0] - std::sin(2.0) * x[1], std::sin(2.0) * x[0] + std::cos(2.0) * x[1],
         flattened * x[2]};
    if (model.prescribed[n] == 0) {
      model.start.velocity[n] = {std::sin(3.0 * static_cast<double>(n)), 1, 0.5};
    }
  }
  return model;
}

TEST(RestGradients, SolveStiffBodiesInFewIterations) {
  const Model model = stiff_model();
  StepperOptions with, plain;
  with.linear_tolerance = plain.linear_tolerance = 1e-12;
  plain.float32_solve = true;
  const auto one = make_cpu_stepper(model, with), other = make_cpu_stepper(model, plain);

  const StepOutcome few = one->step(input_for(model, 0.01, {0, 0, -9.81}));
  const StepOutcome many = other->step(input_for(model, 0.01, {0, 0, -9.81}));

  EXPECT_TRUE(few.converged);
  EXPECT_LE(few.linear_residual, 1e-12);
  EXPECT_LE(few.linear_iterations, without + 30);
  EXPECT_GE(many.linear_iterations, 200);
  const ModelState a = state_of(*one), b = state_of(*other);
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    EXPECT_LT(distance(a.velocity[i], b.velocity[i]), 1e-8);
  }
}

/// Far from their shape at rest bodies take more iterations, but converge.
TEST(RestGradients, SolveFlattenedBodies) {
  const Model model = stiff_model(0.05);
  const auto stepper = make_cpu_stepper(model, {});

  const StepOutcome outcome = stepper->step(input_for(model, 0.01));

  EXPECT_TRUE(outcome.converged);
  EXPECT_LE(outcome.linear_residual, 1e-6);
}

TEST(RestGradients, GiveTheSameBitsOnAnyNumberOfThreads) {
  const Model model = stiff_model();
  const auto one = make_cpu_stepper(model, {.threads = 1});
  const auto three = make_cpu_stepper(model, {.threads = 3});
  for (const double time_step : {0.01, 0.01, 0.005}) {
    EXPECT_GT(one->step(input_for(model, time_step)).linear_iterations, without);
    three->step(input_for(model, time_step));
  }
  EXPECT_EQ(state_of(*one).velocity, state_of(*three).velocity);
}

/// The limit of the caller holds for both parts together.
TEST(RestGradients, KeepToTheMaximumOfIterations) {
  const Model model = stiff_model();
  StepperOptions options;
  options.linear_tolerance = 1e-15;
  options.max_iterations = without;

  const StepOutcome outcome = make_cpu_stepper(model, options)->step(input_for(model, 0.01));

  EXPECT_FALSE(outcome.converged);
  EXPECT_EQ(outcome.linear_iterations, without);
}

}  // namespace
}  // namespace tetwarp::test

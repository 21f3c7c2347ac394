/// @file test_island_factors.cpp
/// Linear solves of cloth by the factors of its system, after a few iterations. Solves in float32
/// do without them.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {

/// A stiff sheet that is bent, of which one corner is held, and a rigid body at another one.
Model stiff_sheet() {
  Model model = empty_model();
  add_sheet(model, 12, 0.01, 1e5, 0.01);
  const std::int32_t rigid = add_rigid(model, 0.1, {1e-4, 2e-4, 3e-4}, {0.12, 0.12, 0});
  add_spring(model, node_point(model, 168), rigid_point(model, rigid, {0, 0, 0}), 1e5);
  model.prescribed[0] = 1;
  for (std::size_t n = 0; n < static_cast<std::size_t>(model.node_count); ++n) {
    model.start.position[n][2] = 0.02 * std::sin(40 * model.start.position[n][0]);
    if (n > 0) model.start.velocity[n] = {std::sin(3.0 * static_cast<double>(n)), 1, 0.5};
  }
  return model;
}

TEST(IslandFactors, SolveStiffClothInFewIterations) {
  const Model model = stiff_sheet();
  StepperOptions with, plain;
  with.linear_tolerance = plain.linear_tolerance = 1e-11;
  plain.float32_solve = true;
  const auto one = make_cpu_stepper(model, with), other = make_cpu_stepper(model, plain);

  const StepOutcome few = one->step(input_for(model, 0.01, {0, 0, -9.81}));
  const StepOutcome many = other->step(input_for(model, 0.01, {0, 0, -9.81}));

  EXPECT_TRUE(few.converged);
  EXPECT_LE(few.linear_residual, 1e-11);
  EXPECT_LT(few.linear_iterations, many.linear_iterations / 2);
  const ModelState a = state_of(*one), b = state_of(*other);
  for (std::size_t i = 0; i < a.velocity.size(); ++i) {
    EXPECT_LT(distance(a.velocity[i], b.velocity[i]), 1e-7);
  }
}

TEST(IslandFactors, GiveTheSameBitsOnAnyNumberOfThreads) {
  const Model model = stiff_sheet();
  const auto one = make_cpu_stepper(model, {.threads = 1});
  const auto three = make_cpu_stepper(model, {.threads = 3});
  for (const double time_step : {0.01, 0.01, 0.005}) {
    one->step(input_for(model, time_step));
    three->step(input_for(model, time_step));
  }
  EXPECT_EQ(state_of(*one).velocity, state_of(*three).velocity);
}

}  // namespace
}  // namespace tetwarp::test

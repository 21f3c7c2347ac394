#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/simulate/body_models.hpp"

namespace tetwarp::test {
namespace {
/// A block that moves, one whose nodes are held, and a sheet at rest.
Model half_moving_model() {
  Model model = empty_model();
  add_block(model, {.cells = {3, 3, 3}});
  const std::int32_t held = add_block(model, {.cells = {3, 3, 3}, .origin = {2, 0, 0}});
  std::fill(model.prescribed.begin() + held, model.prescribed.end(), 1);
  add_sheet(model, 5, 0.1, 100, 0.1);
  model.start.velocity[7] = {0.5, 0.2, 1};
  return model;
}

TEST(StepperSkips, LeaveBitsAsTheyAreAndAreCounted) {
  const Model model = half_moving_model();
  StepperOptions skipping, thorough;
  thorough.skip = {.rotations = false, .blocks = false};
  const auto one = make_cpu_stepper(model, skipping);
  const auto other = make_cpu_stepper(model, thorough);
  for (int n = 0; n < 5; ++n) {
    const double time_step = n < 3 ? 1e-3 : 2e-3;
    const StepOutcome skipped = one->step(input_for(model, time_step));
    const StepOutcome full = other->step(input_for(model, time_step));

    const ModelState a = state_of(*one), b = state_of(*other);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.velocity, b.velocity);
    EXPECT_EQ(full.skipped_rotations, 0);
    EXPECT_EQ(full.skipped_blocks, 0);
    EXPECT_EQ(skipped.skipped_rotations, n == 0 ? 0 : 135);
    if (n == 0 || n == 3) {  // at first, and with another time step, all blocks are assembled
      EXPECT_EQ(skipped.skipped_blocks, 0);
    } else {
      EXPECT_GT(skipped.skipped_blocks, 300);
    }
  }
}

TEST(StepperSkips, StartAnewWithANewState) {
  const Model model = half_moving_model();
  const auto used = make_cpu_stepper(model, {}), fresh = make_cpu_stepper(model, {});
  for (int n = 0; n < 4; ++n) used->step(input_for(model, 1e-3));
  const ModelState state = state_of(*used);
  fresh->set_state(state);

  used->step(input_for(model, 1e-3));
  fresh->step(input_for(model, 1e-3));

  EXPECT_EQ(state_of(*used).position, state_of(*fresh).position);
  EXPECT_EQ(state_of(*used).velocity, state_of(*fresh).velocity);
}

/// Conjugate gradients in float32 reach the tolerance of float64.
TEST(StepperOptions, Float32SolveReachesTheSameTolerance) {
  Model model = empty_model();
  add_block(model, {.cells = {5, 4, 3}, .youngs = 1e6});
  add_rigid(model, 1, {1e-3, 2e-3, 3e-3}, {1, 0, 0});
  add_spring(model, node_point(model, 5), rigid_point(model, 0, {-0.1, 0.1, 0}), 1e3);
  model.start.velocity[3] = {1, -2, 0.5};
  StepperOptions wide, narrow;
  wide.linear_tolerance = narrow.linear_tolerance = 1e-12;
  narrow.float32_solve = true;
  const auto a = make_cpu_stepper(model, wide), b = make_cpu_stepper(model, narrow);
  for (int n = 0; n < 10; ++n) {
    EXPECT_TRUE(a->step(input_for(model, 5e-3, {0, 0, -9.81})).converged);
    const StepOutcome outcome = b->step(input_for(model, 5e-3, {0, 0, -9.81}));
    EXPECT_TRUE(outcome.converged);
    EXPECT_LE(outcome.linear_residual, 1e-12);
  }
  const ModelState wide_state = state_of(*a), narrow_state = state_of(*b);
  for (std::size_t i = 0; i < wide_state.velocity.size(); ++i) {
    EXPECT_LT(distance(wide_state.velocity[i], narrow_state.velocity[i]), 1e-9);
  }
}

TEST(StepperOptions, ProgressEndsAStepWithoutEffect) {
  Model model = empty_model();
  add_block(model, {.cells = {10, 9, 8}, .youngs = 1e8});
  model.start.velocity[3] = {1, -2, 0.5};
  for (const std::int64_t last : {0, 10}) {
    StepperOptions options;
    options.float32_solve = true;  // more than 10 iterations
    options.progress = [last](std::int64_t iterations) { return iterations < last; };
    const auto stepper = make_cpu_stepper(model, options);

    EXPECT_FALSE(stepper->step(input_for(model, 0.01)).completed);

    EXPECT_EQ(state_of(*stepper).position, model.start.position);
    EXPECT_EQ(state_of(*stepper).velocity, model.start.velocity);
  }
}

TEST(StepperOptions, MaximumIterationsAreReportedAsNotConverged) {
  Model model = empty_model();
  add_block(model, {.cells = {4, 4, 4}, .youngs = 1e8});
  model.start.velocity[3] = {1, -2, 0.5};
  StepperOptions options;
  options.max_iterations = 3;

  const StepOutcome outcome = make_cpu_stepper(model, options)->step(input_for(model, 0.01));

  EXPECT_FALSE(outcome.converged);
  EXPECT_EQ(outcome.linear_iterations, 3);
  EXPECT_GT(outcome.linear_residual, 1e-6);
}

/// Steps until a noisy, flattened or collapsed block is at rest again.
ModelState relaxed(const Model& model, const ModelState& start, int steps) {
  StepperOptions options;
  options.linear_tolerance = 1e-8;
  const auto stepper = make_cpu_stepper(model, options);
  stepper->set_state(start);
  for (int n = 0; n < steps; ++n) stepper->step(input_for(model, 0.01));
  return state_of(*stepper);
}

double strain_energy_share(const Model& model, const ModelState& state) {
  double volume = 0;
  for (const double v : model.tets.volume) volume += v;
  return elastic_energy(model, state) / (1e4 * volume);
}

TEST(InvertedElements, RecoverFromNoiseAndFromAPlane) {
  Model model = empty_model();
  add_block(model, {.cells = {3, 3, 3}, .edge = 0.1, .youngs = 1e4, .gamma = 2e-2});
  std::mt19937 random(2);
  for (int run = 0; run < 4; ++run) {
    ModelState start = model.start;
    std::uniform_real_distribution<double> noise(-0.1 * run, 0.1 * run);
    for (Point3& p : start.position) {
      if (run == 0) p[2] = 0;
      for (double& x : p) x += noise(random);
    }
    if (run > 0) {
      EXPECT_GT(inverted_count(model, start), 5);
    }

    const ModelState end = relaxed(model, start, 400);

    EXPECT_EQ(inverted_count(model, end), 0) << run;
    EXPECT_LT(strain_energy_share(model, end), 1e-5) << run;
  }
}

/// Extremes of stiffness, time step and shape keep every number finite.
TEST(StepperExtremes, AreFreeOfNaN) {
  for (const double youngs : {1.0, 1e12}) {
    for (const double time_step : {1e-5, 5e-2}) {
      for (const int shape : {0, 1, 2}) {
        Model model = empty_model();
        add_block(model, {.cells = {3, 2, 2}, .youngs = youngs});
        add_sheet(model, 3, 0.1, youngs, 0.01);
        add_rigid(model, 1e-6, {1e-12, 1e-6, 1}, {1, 0, 0});
        model.start.angular_momentum[0] = {1e-6, 1, 1};
        for (Point3& p : model.start.position) {
          if (shape == 1) p = {0, 0, 0};
          if (shape == 2) p[0] = 1e6 - p[0];
        }
        model.start.velocity[1] = {1e3, 0, 0};
        StepperOptions options;
        options.max_iterations = 500;
        const auto stepper = make_cpu_stepper(model, options);
        for (int n = 0; n < 5; ++n) stepper->step(input_for(model, time_step, {0, 0, -9.81}));

        const ModelState state = state_of(*stepper);
        for (const auto* points : {&state.position, &state.velocity, &state.angular_momentum}) {
          for (const Point3& p : *points) {
            for (const double x : p) EXPECT_TRUE(std::isfinite(x));
          }
        }
      }
    }
  }
}

TEST(StepperArguments, OfWrongSizeAreNamed) {
  Model model = empty_model();
  add_block(model, {});
  const auto stepper = make_cpu_stepper(model, {});
  StepInput input = input_for(model, 0.01);
  input.block_force.pop_back();

  EXPECT_THROW(stepper->step(input), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test

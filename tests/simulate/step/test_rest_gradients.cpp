/// Linear solves of elastic bodies by their factors at rest. Solves in float32 do without them.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "host/simulate/step/cpu/rest_factors.hpp"
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

/// Two stiff blocks, tied by springs at nodes of their facing sides.
Model tied_model(double spring) {
  Model model = empty_model();
  add_block(model, {.cells = {3, 3, 3}, .youngs = 1e7});
  const std::int32_t second =
      add_block(model, {.cells = {3, 3, 3}, .origin = {0.3, 0, 0}, .youngs = 1e7});
  for (std::int32_t n = 0; n < second; n += 4) {
    add_spring(model, node_point(model, n + 3), node_point(model, second + n), spring, 1);
  }
  for (std::size_t n = 0; n < model.start.velocity.size(); ++n) {
    model.start.velocity[n] = {std::sin(3.0 * static_cast<double>(n)), 1, 0.5};
  }
  return model;
}

TEST(RestGradients, SolveTiedBodiesInFewIterations) {
  StepperOptions with, plain;
  with.linear_tolerance = plain.linear_tolerance = 1e-12;
  plain.float32_solve = true;
  for (const double spring : {1e2, 1e4, 1e6}) {
    SCOPED_TRACE(spring);
    const Model model = tied_model(spring);
    const auto one = make_cpu_stepper(model, with), other = make_cpu_stepper(model, plain);

    const StepOutcome few = one->step(input_for(model, 0.01, {0, 0, -9.81}));
    const StepOutcome many = other->step(input_for(model, 0.01, {0, 0, -9.81}));

    EXPECT_TRUE(few.converged);
    EXPECT_LE(few.linear_residual, 1e-12);
    EXPECT_LT(2 * few.linear_iterations, many.linear_iterations);
    const ModelState a = state_of(*one), b = state_of(*other);
    for (std::size_t i = 0; i < a.velocity.size(); ++i) {
      EXPECT_LT(distance(a.velocity[i], b.velocity[i]), 1e-8);
    }
  }
}

/// v^T A v of tied bodies is at most that of their matrices at rest. Where springs are soft it is
/// nearly that.
TEST(RestFactors, BoundTheMatrixOfTiedBodies) {
  constexpr double time_step = 0.01;
  for (const double spring : {1.0, 1e3, 1e6}) {
    SCOPED_TRACE(spring);
    const Model model = tied_model(spring);
    const auto stepper = make_cpu_stepper(model, {});
    stepper->solve(input_for(model, time_step));
    const StepSystem system = stepper->system();
    const Eigen::Index size = 3 * system.rows.unknown_count;
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size), inverse = a;
    for (std::int32_t row = 0; row < system.rows.unknown_count; ++row) {
      for (std::int32_t k = system.rows.start[row]; k < system.rows.free_end[row]; ++k) {
        a.block<3, 3>(3 * row, 3 * system.rows.column[k]) =
            Eigen::Map<const Eigen::Matrix3d>(system.values.data + 9 * std::int64_t{k});
      }
    }
    RestFactors factors(model);
    factors.set_time_step(time_step);
    for (const std::int32_t body : {0, 1}) {
      std::vector<float> numbers;
      factors.of_body(body).inverse(numbers);
      const Eigen::Index half = size / 2;
      inverse.block(body * half, body * half, half, half) =
          Eigen::Map<const Eigen::MatrixXf>(numbers.data(), half, half).cast<double>();
    }
    const Eigen::MatrixXd factor = a.llt().matrixL();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(factor.transpose() * inverse *
                                                               factor);
    EXPECT_LE(eigen.eigenvalues().maxCoeff(), 1 + 1e-3);
    EXPECT_GT(eigen.eigenvalues().minCoeff(), spring == 1 ? 0.95 : 0);
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

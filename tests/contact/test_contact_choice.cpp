/// @file test_contact_choice.cpp
/// The choice between sweeps and Newton's method, and the equations of Newton's method in a fixed
/// pattern.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/contact_assembly.hpp"
#include "host/contact/newton/newton.hpp"
#include "host/contact/newton/newton_system.hpp"
#include "host/contact/problem/matrix.hpp"
#include "host/contact/solve/method_choice.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double infinity = std::numeric_limits<double>::infinity();

ContactSolution solve_by(const ContactProblem& problem, ContactMethod method, double tolerance) {
  return solve_contacts(problem, {.method = method, .tolerance = tolerance});
}

/// A symmetric positive definite block.
Matrix3d random_block(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Matrix3d root = Matrix3d::NullaryExpr([&] { return number(random); });
  return root * root.transpose() + 0.1 * Matrix3d::Identity();
}

TEST(ContactChoice, PredictsSweepsByTheRateOfTheLastOnes) {
  EXPECT_DOUBLE_EQ(sweeps_left(400, 50, 30), 30 * std::log(100) / std::log(8));
  EXPECT_DOUBLE_EQ(sweeps_left(1000, 50, 50), 50 * std::log(100) / std::log(20));
  EXPECT_EQ(sweeps_left(10, 10, 50), infinity);
  EXPECT_EQ(sweeps_left(10, 11, 50), infinity);
  EXPECT_EQ(sweeps_left(infinity, 10, 50), infinity);
}

/// A factorization costs the more sweeps, the more entries its factor has.
TEST(ContactChoice, CountsTheFillOfAFactorization) {
  const ContactProblem stack = scenes::box_stack({.boxes = 20});
  const ContactProblem packing = scenes::sphere_packing({.edge = 4});
  const NewtonCost chain = newton_cost(stack, infinity), dense = newton_cost(packing, infinity);

  EXPECT_LT(chain.flops, 20 * 36 * 36 * 6);
  EXPECT_GT(dense.flops, 10 * chain.flops);
  EXPECT_LT(sweeps_per_newton_step(chain, stack.contact_count()),
            sweeps_per_newton_step(dense, packing.contact_count()));
}

TEST(ContactChoice, LeavesSweepsThatPromiseToTakeLongerThanATrialThatMayFail) {
  EXPECT_FALSE(prefers_newton(1000, 5000, 900));
  EXPECT_FALSE(prefers_newton(1000, 1300, 1100));
  EXPECT_TRUE(prefers_newton(1000, 1500, 1100));
  EXPECT_FALSE(prefers_newton(1000, 220, infinity));
  EXPECT_TRUE(prefers_newton(1000, 230, infinity));
  EXPECT_FALSE(prefers_newton(infinity, 100000, infinity));
}

TEST(ContactChoice, ExpectsMoreNewtonStepsWhereFactorsFill) {
  EXPECT_EQ(newton_worth(20), 20);
  EXPECT_EQ(newton_worth(30), 30);
  EXPECT_EQ(newton_worth(60), 4 * 60);
  EXPECT_EQ(newton_worth(infinity), infinity);
}

TEST(ContactChoice, ChangesSweepsThatAreSlowThreeTimesInARow) {
  SweepChoice choice;
  const auto after = [&](std::int64_t spent, double left) {
    choice.note(spent, left);
    return choice.current();
  };
  EXPECT_EQ(after(100, 900), ContactMethod::nonlinear_cg);
  EXPECT_EQ(after(200, 1700), ContactMethod::nonlinear_cg);
  EXPECT_EQ(after(300, 300), ContactMethod::nonlinear_cg);
  EXPECT_EQ(after(400, infinity), ContactMethod::nonlinear_cg);
  EXPECT_EQ(after(500, infinity), ContactMethod::nonlinear_cg);
  EXPECT_EQ(after(600, 8000), ContactMethod::anderson);
  EXPECT_EQ(after(700, 7000), ContactMethod::anderson);
  EXPECT_EQ(after(800, 7000), ContactMethod::anderson);
  EXPECT_EQ(after(850, 7900), ContactMethod::anderson) << "quicker than conjugate directions were";
  EXPECT_EQ(after(900, 9000), ContactMethod::nonlinear_cg);
}

/// A stack needs some ten Newton steps, which cost less than the sweeps that would follow.
TEST(ContactChoice, TriesNewtonOnStacksBeforeSweepsAreMany) {
  const ContactSolution solution =
      solve_by(scenes::box_stack({.boxes = 20}), ContactMethod::automatic, 1e-6);

  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  EXPECT_LE(solution.report.sweeps, 1000);
  EXPECT_GT(solution.report.newton_iterations, 0);
  EXPECT_LE(solution.report.newton_iterations, 60);
}

/// The sweeps before Newton's method are in proportion to its cost, and it does not start with
/// proximal points that lead nowhere.
TEST(ContactChoice, TakesFewNewtonStepsOnJamsAndStacks) {
  for (const ContactProblem& problem :
       {scenes::jam({.seed = 1}), scenes::box_stack({.mass_ratio = 1e4, .friction = 0.5})}) {
    const ContactSolution solution = solve_by(problem, ContactMethod::automatic, 1e-8);

    EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
    EXPECT_LE(solution.report.newton_iterations, 60);
  }
}

/// Where conjugate directions alone converge, the choice takes few more updates and no
/// factorization.
TEST(ContactChoice, IsCloseToTheBestMethodWhereSweepsConverge) {
  for (const ContactProblem& problem :
       {scenes::sphere_packing({.edge = 4, .friction = 0.3, .gaps = 0}),
        scenes::jam(
            {.seed = 3, .bodies = 30, .contacts = 150, .mass_ratio = 1e4, .friction = 0.5})}) {
    const ContactReport own = solve_by(problem, ContactMethod::automatic, 1e-6).report;
    const ContactReport best = solve_by(problem, ContactMethod::nonlinear_cg, 1e-6).report;

    EXPECT_EQ(own.status, ContactStatus::converged);
    EXPECT_EQ(own.newton_iterations, 0);
    EXPECT_LE(static_cast<double>(own.contact_updates),
              1.5 * static_cast<double>(best.contact_updates));
  }
}

/// The residual of sweeps is small near impulses that are no solution, and grows before it drops.
/// Newton's method, which finds no solution there, takes no longer than the sweeps before it.
TEST(ContactChoice, SweepsPassImpulsesOfASmallResidualThatAreNoSolution) {
  const ContactProblem problem = scenes::sphere_packing({.edge = 4, .friction = 0.5, .gaps = 0});
  const ContactReport own = solve_by(problem, ContactMethod::automatic, 1e-6).report;
  const ContactReport best = solve_by(problem, ContactMethod::nonlinear_cg, 1e-6).report;

  EXPECT_EQ(own.status, ContactStatus::converged);
  EXPECT_LE(own.newton_iterations, 60);
  EXPECT_LE(own.sweeps, 2 * best.sweeps);
}

TEST(NewtonPolish, EndsAfterItsLimitOfLinearSystems) {
  const ContactProblem problem = scenes::sphere_packing({.edge = 4, .friction = 0.5, .gaps = 0});
  for (const std::int64_t limit : {0, 10, 40, 100}) {
    std::vector<double> impulse, body_velocity;
    const NewtonResult result =
        newton_polish(problem, {}, impulse, body_velocity, nullptr, {.total = limit});
    EXPECT_LE(result.iterations, limit + 12);
    EXPECT_GE(result.iterations, limit);
  }
}

TEST(ContactChoice, IsTheSameForAnyNumberOfThreads) {
  const ContactProblem problem = scenes::jam({.seed = 1});
  const ContactSolution one = solve_contacts(problem, {.tolerance = 1e-8, .threads = 1});
  const ContactSolution three = solve_contacts(problem, {.tolerance = 1e-8, .threads = 3});

  EXPECT_EQ(one.impulse, three.impulse);
  EXPECT_EQ(one.report.sweeps, three.report.sweeps);
}

TEST(ContactAssembly, AddsTheContactsToTheSystem) {
  const ContactProblem problem = scenes::sphere_packing({.edge = 3});
  const Eigen::SparseMatrix<double> system = make_eigen(problem.system),
                                    jacobian = make_eigen(problem.jacobian);
  ContactAssembly assembly(system, jacobian);
  std::mt19937 random(1);
  for (int round = 0; round < 2; ++round) {
    std::vector<Matrix3d> blocks;
    MatrixXd dense = MatrixXd::Zero(jacobian.rows(), jacobian.rows());
    for (Eigen::Index c = 0; c < jacobian.rows() / 3; ++c) {
      blocks.push_back(random_block(random));
      blocks.back()(0, 1) += 1;  // not symmetric, like sliding friction
      dense.block<3, 3>(3 * c, 3 * c) = blocks.back();
    }

    const MatrixXd sum = assembly.sum(blocks);

    const MatrixXd expected = MatrixXd(system) + MatrixXd(jacobian).transpose() * dense * jacobian;
    EXPECT_LE((sum - expected).norm(), 1e-13 * expected.norm());
  }
}

TEST(NewtonSystem, SolvesTheSameEquationsByCholesky) {
  for (const ContactProblem& problem :
       {scenes::sphere_packing({.edge = 4}), scenes::random_local({.contacts = 30})}) {
    const Delassus delassus(problem, infinity);
    NewtonSystem system(problem, delassus);
    std::mt19937 random(2);
    std::vector<MapDerivative> derivatives;
    for (std::int64_t c = 0; c < problem.contact_count(); ++c) {
      derivatives.push_back({random_block(random), Matrix3d::Identity()});
    }
    const VectorXd right_side = VectorXd::Random(3 * problem.contact_count());
    ASSERT_TRUE(system.factorize(derivatives));
    const VectorXd general = system.solve(right_side);
    ASSERT_TRUE(system.factorize_symmetric(derivatives));

    EXPECT_LE((system.solve(right_side) - general).norm(), 1e-9 * general.norm());
  }
}
}  // namespace
}  // namespace tetwarp::test

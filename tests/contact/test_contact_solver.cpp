/// @file test_contact_solver.cpp
/// A solver used for several problems; independent islands; infeasible contacts; bodies without
/// contacts.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/contact/contact_stages.hpp"

namespace tetwarp::test {
namespace {
using Numbers = std::vector<double>;

/// cuda is used only if it is named.
TEST(ContactSolver, RunsOnTheCpuByDefault) {
  const auto [automatic, reason] = choose_contact_backend(Backend::automatic);
  const ContactReport report = solve_contacts(local_problem(90, 2)).report;

  EXPECT_EQ(automatic, Backend::cpu);
  EXPECT_FALSE(reason.empty());
  EXPECT_EQ(report.backend, Backend::cpu);
  EXPECT_EQ(choose_contact_backend(Backend::reference).first, Backend::reference);
}

/// Also when structure, size and form have changed in between.
TEST(ContactSolver, UsedAgainGivesTheBitsOfANewOne) {
  ContactProblem moved = global_problem(91, 6, 0);
  for (double& value : moved.load) value = -value;
  ContactProblem stiffer = global_problem(91, 6, 0.4);
  for (double& value : stiffer.system.value) value *= 2;
  const ContactProblem sequence[] = {
      global_problem(91, 6, 0), moved,   global_problem(92, 4, 0),   local_problem(93, 12),
      local_problem(93, 3),     stiffer, global_problem(91, 6, 0.4), global_problem(91, 6, 0)};
  ContactSolver solver({.tolerance = 1e-9});
  for (std::size_t k = 0; k < std::size(sequence); ++k) {
    expect_same_bits(solver.solve(sequence[k]), solve_contacts(sequence[k], {.tolerance = 1e-9}),
                     "problem " + std::to_string(k));
  }
}

/// A stored zero becomes a coupling and a zero again: the index arrays are the same, the structures
/// are not.
TEST(ContactSolver, DetectsStoredZerosThatComeAndGo) {
  ContactProblem coupled = global_problem(94, 3, 0.4), loose = coupled;
  for (std::int64_t row = 0; row < 18; ++row) {
    const auto r = static_cast<std::size_t>(row);
    for (std::int64_t e = coupled.system.row_start[r]; e < coupled.system.row_start[r + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      if (coupled.system.column[entry] / 6 != row / 6) loose.system.value[entry] = 0;
    }
  }
  ContactSolver solver({.tolerance = 1e-9});
  for (const ContactProblem& problem : {loose, coupled, loose}) {
    expect_same_bits(solver.solve(problem), solve_contacts(problem, {.tolerance = 1e-9}), "");
  }
}

/// Many islands, in another order than their contacts; coupled and uncoupled bodies.
TEST(ContactSolver, ReportsTheContactFarthestFromItsLawAndTheBalance) {
  const ContactProblem packing = scenes::sphere_packing({.seed = 98, .edge = 5, .kept = 0.2});
  for (const ContactProblem& problem :
       {local_problem(98, 30), packing, global_problem(98, 12, 0.4)}) {
    const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-3});
    const ContactResidual& reported = solution.report.residual;
    const ContactResidual expected = residual_of(problem, solution.impulse, solution.body_velocity);

    EXPECT_GE(reported.largest_contact, 0);
    EXPECT_EQ(reported.largest_contact, expected.largest_contact);
    EXPECT_NEAR(reported.largest, expected.largest, 1e-6 * expected.largest);
    EXPECT_LE(reported.largest, reported.eta);
    EXPECT_LE(reported.balance, 1e-13);
    EXPECT_EQ(reported.balance > 0, !problem.is_local());  // rounding leaves something
  }
}

TEST(ContactSolver, IslandsTogetherHaveTheVelocitiesOfEachAlone) {
  const ContactProblem parts[] = {local_problem(95, 9), local_problem(96, 1),
                                  local_problem(97, 14)};
  Eigen::Index rows = 0;
  Eigen::MatrixXd delassus = Eigen::MatrixXd::Zero(72, 72);
  ContactProblem whole = parts[0];
  whole.free_velocity.clear();
  whole.friction.clear();
  whole.adhesion = {};
  whole.adhesion.time_step = parts[0].adhesion.time_step;
  Numbers expected;
  for (const ContactProblem& part : parts) {
    const Eigen::Index size = part.delassus.rows;
    for (Eigen::Index row = 0; row < size; ++row) {  // every entry is stored
      for (Eigen::Index column = 0; column < size; ++column) {
        delassus(rows + row, rows + column) =
            part.delassus.value[static_cast<std::size_t>(row * size + column)];
      }
    }
    rows += size;
    const auto append = [](Numbers& to, const Numbers& from) {
      to.insert(to.end(), from.begin(), from.end());
    };
    append(whole.free_velocity, part.free_velocity);
    append(whole.friction, part.friction);
    for (Numbers AdhesionState::*member :
         {&AdhesionState::area, &AdhesionState::stiffness, &AdhesionState::tangential_stiffness,
          &AdhesionState::intensity, &AdhesionState::gap}) {
      append(whole.adhesion.*member, part.adhesion.*member);
    }
    append(expected, solve_contacts(part, {.tolerance = 1e-10}).velocity);
  }
  whole.delassus = samples::sparse_of(delassus);

  const ContactSolution solution = solve_contacts(whole, {.tolerance = 1e-10});

  EXPECT_EQ(solution.report.islands, 3);
  EXPECT_LE(relative_distance(solution.velocity, expected), 1e-7);
}

/// A point between two walls that are closer than it is thick, and a free point beside it.
TEST(ContactSolver, ASqueezedBodyEndsInfeasibleAndFiniteWithinTheBudget) {
  ContactProblem problem;
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(9, 6);
  jacobian.block<3, 3>(0, 0) = Eigen::Matrix3d::Identity();
  jacobian.block<3, 3>(3, 0) = -Eigen::Matrix3d::Identity();
  jacobian.block<3, 3>(6, 3) = Eigen::Matrix3d::Identity();
  problem.system = samples::sparse_of(Eigen::MatrixXd::Identity(6, 6));
  problem.jacobian = samples::sparse_of(jacobian);
  problem.load = {0.5, 1, 0, -2, 0, 0};
  problem.velocity_offset = {-1, 0, 0, -1, 0, 0, 1, 0, 0};
  problem.friction = {0.5, 0.5, 0};
  for (const ContactMethod method : methods) {
    const ContactSolution solution =
        solve_contacts(problem, {.method = method, .tolerance = 1e-9, .max_sweeps = 300});

    EXPECT_EQ(solution.report.status, ContactStatus::infeasible) << report_name_of(method);
    EXPECT_NE(solution.report.status_reason, "") << report_name_of(method);
    EXPECT_LE(solution.report.sweeps, 300) << report_name_of(method);
    for (const Numbers* values : {&solution.impulse, &solution.velocity, &solution.body_velocity}) {
      for (const double value : *values) EXPECT_LE(std::abs(value), 10) << report_name_of(method);
    }
    EXPECT_NEAR(solution.body_velocity[0], 0, 1e-8) << report_name_of(method);  // stays where it is
    EXPECT_NEAR(solution.body_velocity[3], -1, 1e-8)
        << report_name_of(method);  // stops at its wall
  }
}

TEST(ContactSolver, WithoutContactsBodiesMoveFreely) {
  ContactProblem problem;
  problem.system = samples::sparse_of(4 * Eigen::Matrix3d::Identity());
  problem.jacobian = {0, 3, {0}, {}, {}};
  problem.load = {4, 8, 12};
  for (const ContactMethod method : methods) {
    const ContactSolution solution = solve_contacts(problem, {.method = method});

    EXPECT_TRUE(solution.converged());
    EXPECT_TRUE(solution.impulse.empty() && solution.velocity.empty());
    EXPECT_EQ(solution.body_velocity, (Numbers{1, 2, 3}));
    EXPECT_EQ(solution.report.residual.eta, 0);
  }
}

/// More than ten digits below the initial residual, with one island and with several.
TEST(ContactSolver, TheHistoryEndsWithTheResidual) {
  const ContactProblem one = local_problem(93, 12);
  const ContactProblem several = scenes::sphere_packing({.edge = 5, .friction = 0, .kept = 0.15});
  for (const ContactProblem* problem : {&one, &several}) {
    const ContactReport report =
        solve_contacts(*problem, {.method = ContactMethod::gauss_seidel, .tolerance = 1e-12})
            .report;

    ASSERT_GE(report.residual_history.size(), 2U);
    EXPECT_GT(report.residual_history.front(), 1e-3);
    // The report recomputes velocities, whose rounding is visible at this residual.
    EXPECT_NEAR(report.residual_history.back(), report.residual.eta, 0.01 * report.residual.eta);
  }
}

/// Iterations over bodies that A couples are in float64 with either precision.
TEST(ContactSolver, IteratesCoupledBodiesInFloat64) {
  const ContactProblem problem = scenes::elastic_slab({.cubes = {6, 5, 2}, .contacts = 30});
  ContactOptions options = {.max_sweeps = 100000,
                            .expert = {.coupling = ContactCoupling::iterated}};
  for (const double tolerance : {1e-3, 1e-9}) {
    options.tolerance = tolerance;
    options.precision = ContactPrecision::float64;
    const ContactSolution fine = solve_contacts(problem, options);
    options.precision = ContactPrecision::float32;

    const ContactSolution other = solve_contacts(problem, options);

    EXPECT_TRUE(fine.converged()) << tolerance;
    EXPECT_LE(residual_of(problem, fine.impulse, fine.body_velocity).eta, tolerance);
    EXPECT_EQ(other.impulse, fine.impulse) << tolerance;
  }
}
}  // namespace
}  // namespace tetwarp::test

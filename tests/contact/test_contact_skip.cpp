/// @file test_contact_skip.cpp
/// Work that is left out changes no result beyond the tolerance, and is counted.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/contact.hpp>

#include "tests/support/contact/contact_samples.hpp"
#include "tests/support/contact/contact_stages.hpp"

namespace tetwarp::test {
namespace {
constexpr double tolerance = 1e-10;

using Switch = bool ContactSkipOptions::*;

ContactSolution solve(const ContactProblem& problem,
                      Switch choice,
                      bool is_on,
                      ContactMethod method = ContactMethod::automatic) {
  ContactOptions options{.method = method, .tolerance = tolerance, .max_sweeps = 100000};
  options.expert.skip.*choice = is_on;
  ContactSolution solution = solve_contacts(problem, options);
  EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
  return solution;
}

void expect_agreement(const ContactSolution& on, const ContactSolution& off) {
  EXPECT_LE(relative_distance(on.velocity, off.velocity), 1e-8);
  EXPECT_LE(relative_distance(on.body_velocity, off.body_velocity), 1e-8);
}

ContactProblem local_problem(std::uint32_t seed, std::int64_t contacts) {
  std::mt19937 random(seed);
  return samples::random_local(random, contacts, 0.3, samples::random_kappa(random, contacts));
}

/// `rows` rows of one, two, ... bodies; each row is an island.
ContactProblem rows_of_bodies(std::uint32_t seed, Eigen::Index rows) {
  std::mt19937 random(seed);
  ContactProblem whole;
  Eigen::Index dofs = 0, contacts = 0;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(3 * rows * (rows + 1), 3 * rows * (rows + 1));
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(3 * rows * rows, system.cols());
  for (Eigen::Index count = 1; count <= rows; ++count) {
    const ContactProblem part = samples::random_global(random, count, 6, 0, 0.3);
    const auto place = [](const SparseMatrix& from, Eigen::Index row, Eigen::Index column,
                          Eigen::MatrixXd& to) {
      for (std::size_t r = 0; r < static_cast<std::size_t>(from.rows); ++r) {
        for (std::int64_t e = from.row_start[r]; e < from.row_start[r + 1]; ++e) {
          const auto entry = static_cast<std::size_t>(e);
          to(row + static_cast<Eigen::Index>(r), column + from.column[entry]) = from.value[entry];
        }
      }
    };
    place(part.system, dofs, dofs, system);
    place(part.jacobian, 3 * contacts, dofs, jacobian);
    whole.load.insert(whole.load.end(), part.load.begin(), part.load.end());
    whole.velocity_offset.insert(whole.velocity_offset.end(), part.velocity_offset.begin(),
                                 part.velocity_offset.end());
    whole.friction.insert(whole.friction.end(), part.friction.begin(), part.friction.end());
    dofs += part.dof_count();
    contacts += part.contact_count();
  }
  whole.system = samples::sparse_of(system);
  whole.jacobian = samples::sparse_of(jacobian);
  for (std::int32_t dof = 0; dof <= dofs; dof += 6) whole.block_start.push_back(dof);
  return whole;
}

TEST(ContactSkip, RowsOfContactsWithoutFrictionAndSpringsAreLeftOut) {
  ContactProblem problem = local_problem(101, 20);
  std::int64_t bare = 0;
  for (std::size_t c = 0; c < 20; ++c) {
    if (c % 2 == 0) problem.friction[c] = 0;
    bare += problem.friction[c] == 0 && problem.adhesion.stiffness[c] == 0;
  }
  ASSERT_GE(bare, 1);

  const ContactSolution on = solve(problem, &ContactSkipOptions::frictionless_rows, true);
  const ContactSolution off = solve(problem, &ContactSkipOptions::frictionless_rows, false);

  EXPECT_EQ(on.report.rows_skipped, 2 * bare);
  EXPECT_EQ(off.report.rows_skipped, 0);
  expect_agreement(on, off);
}

TEST(ContactSkip, ContactsThatLetGoCarryNoSprings) {
  ContactProblem problem = local_problem(102, 20);
  std::int64_t debonded = 0;
  for (std::size_t c = 0; c < 20; ++c) {
    if (c % 3 == 0) problem.adhesion.intensity[c] = 0;
    debonded += problem.adhesion.intensity[c] == 0;
  }

  const ContactSolution on = solve(problem, &ContactSkipOptions::debonded_springs, true);
  const ContactSolution off = solve(problem, &ContactSkipOptions::debonded_springs, false);

  EXPECT_GE(debonded, 7);
  EXPECT_EQ(on.report.springs_skipped, debonded);
  EXPECT_EQ(off.report.springs_skipped, 0);
  expect_agreement(on, off);
}

/// Two coupled bodies out of five have no contacts.
TEST(ContactSkip, BodiesThatNoContactReachesAreSolvedApart) {
  std::mt19937 random(103);
  const ContactProblem touched = samples::random_global(random, 3, 6, 0.3, 0.3);
  const ContactProblem apart = samples::random_global(random, 2, 6, 0.3, 0.3);
  ContactProblem problem = touched;
  SparseMatrix& system = problem.system;
  for (std::size_t row = 0; row < 12; ++row) {
    for (std::int64_t e = apart.system.row_start[row]; e < apart.system.row_start[row + 1]; ++e) {
      system.column.push_back(apart.system.column[static_cast<std::size_t>(e)] + 18);
      system.value.push_back(apart.system.value[static_cast<std::size_t>(e)]);
    }
    system.row_start.push_back(static_cast<std::int64_t>(system.value.size()));
  }
  system.rows = system.columns = problem.jacobian.columns = 30;
  problem.load.insert(problem.load.end(), apart.load.begin(), apart.load.end());
  problem.block_start = {0, 6, 12, 18, 24, 30};

  const ContactSolution on = solve(problem, &ContactSkipOptions::contactless_bodies, true);
  const ContactSolution off = solve(problem, &ContactSkipOptions::contactless_bodies, false);
  const ContactSolution reference = solve_contacts(problem, {.backend = Backend::reference});

  EXPECT_EQ(on.report.bodies_skipped, 2);
  EXPECT_EQ(off.report.bodies_skipped, 0);
  expect_agreement(on, off);
  expect_agreement(on, reference);
  EXPECT_LE(residual_of(problem, on.impulse, on.body_velocity).balance, 1e-12);
}

TEST(ContactSkip, AConvergedIslandStopsBeforeTheOthers) {
  const ContactProblem problem = rows_of_bodies(104, 5);

  const ContactSolution on = solve(problem, &ContactSkipOptions::converged_islands, true);
  const ContactSolution off = solve(problem, &ContactSkipOptions::converged_islands, false);

  EXPECT_EQ(on.report.islands, 5);
  EXPECT_GE(on.report.islands_stopped, 1);
  EXPECT_LT(on.report.islands_stopped, 5);
  EXPECT_LT(on.report.contact_updates, 25 * on.report.sweeps);
  EXPECT_EQ(off.report.islands_stopped, 0);
  EXPECT_EQ(off.report.contact_updates, 25 * off.report.sweeps);
  expect_agreement(on, off);
}

/// Updates done and left out add up to a visit of every contact in every sweep. Contacts that part
/// are at rest from the first sweep on.
TEST(ContactSkip, ContactsAtRestAreVisitedLessOften) {
  std::mt19937 random(106);
  const ContactProblem rows = samples::random_global(random, 10, 6, 0, 0.3);
  const ContactProblem local = samples::random_local(random, 20, 0.3, {}, 300);
  for (const ContactProblem& problem : {rows, local}) {
    const ContactSolution on =
        solve(problem, &ContactSkipOptions::frozen_contacts, true, ContactMethod::gauss_seidel);
    const ContactSolution off =
        solve(problem, &ContactSkipOptions::frozen_contacts, false, ContactMethod::gauss_seidel);

    const std::int64_t contacts = problem.contact_count();
    EXPECT_GT(on.report.updates_skipped, 0);
    EXPECT_EQ(on.report.contact_updates + on.report.updates_skipped, contacts * on.report.sweeps);
    EXPECT_EQ(off.report.updates_skipped, 0);
    EXPECT_EQ(off.report.contact_updates, contacts * off.report.sweeps);
    expect_agreement(on, off);
  }
}

/// The third problem has another A.
TEST(ContactSkip, CoupledIslandsStayCondensedWhileTheSystemStays) {
  std::mt19937 random(107);
  const ContactProblem problem = samples::random_global(random, 8, 6, 0.3, 0.3);
  ContactProblem pushed = problem;
  for (double& load : pushed.load) load *= 1.1;
  ContactProblem stiffer = pushed;
  for (double& value : stiffer.system.value) value *= 2;
  ContactOptions options{.tolerance = tolerance, .max_sweeps = 100000};
  ContactSolver on(options);
  options.expert.skip.constant_systems = false;
  ContactSolver off(options);
  const std::pair<const ContactProblem*, std::int64_t> steps[] = {
      {&problem, 0}, {&pushed, 1}, {&stiffer, 0}, {&stiffer, 1}};
  for (const auto& [step, kept] : steps) {
    const ContactSolution with = on.solve(*step), without = off.solve(*step);

    EXPECT_EQ(with.report.condensations_kept, kept);
    EXPECT_EQ(without.report.condensations_kept, 0);
    expect_agreement(with, without);
  }
}
}  // namespace
}  // namespace tetwarp::test

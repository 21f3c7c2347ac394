/// @file test_contact_bilateral.cpp
/// Bilateral rows: closed forms of joints, springs and motors, all methods and forms against the
/// reference, and bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tetwarp/contact.hpp>
#include <vector>

#include "tests/support/contact/contact_methods.hpp"
#include "tests/support/contact/contact_rows.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
/// Point masses that move along z only, without contacts.
ContactProblem masses_on_a_line(const std::vector<double>& mass, const std::vector<double>& load) {
  ContactProblem problem;
  problem.system.rows = problem.system.columns = std::ssize(mass);
  problem.system.row_start = {0};
  for (std::size_t i = 0; i < mass.size(); ++i) {
    problem.system.column.push_back(static_cast<std::int32_t>(i));
    problem.system.value.push_back(mass[i]);
    problem.system.row_start.push_back(static_cast<std::int64_t>(i) + 1);
  }
  problem.load = load;
  return problem;
}

/// Rows v_i - v_j; j < 0: v_i.
void add_links(ContactProblem& problem, const std::vector<std::pair<int, int>>& links) {
  SparseMatrix& jacobian = problem.bilateral.jacobian;
  jacobian = {std::ssize(links), problem.dof_count(), {0}, {}, {}};
  for (const auto& [i, j] : links) {
    jacobian.column.push_back(i);
    jacobian.value.push_back(1);
    if (j >= 0) {
      jacobian.column.push_back(j);
      jacobian.value.push_back(-1);
    }
    jacobian.row_start.push_back(std::ssize(jacobian.column));
  }
}

/// A contact of the mass at dof `i` with a floor below it.
void add_floor(ContactProblem& problem, std::int32_t i) {
  problem.jacobian = {3, problem.dof_count(), {0, 1, 1, 1}, {i}, {1}};
  problem.velocity_offset = {0, 0, 0};
  problem.friction = {0};
}

TEST(ContactBilateral, AJointSharesTheMomentum) {
  for (const ContactMethod method : methods) {
    ContactProblem problem = masses_on_a_line({1, 3}, {2, -3});
    add_links(problem, {{0, 1}});

    const ContactSolution solution =
        solve_contacts(problem, {.method = method, .tolerance = 1e-12});

    EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
    EXPECT_NEAR(solution.body_velocity[0], -0.25, 1e-14);
    EXPECT_NEAR(solution.body_velocity[1], -0.25, 1e-14);
    ASSERT_EQ(solution.bilateral_impulse.size(), 1U);
    EXPECT_NEAR(solution.bilateral_impulse[0], -2.25, 1e-14);
    EXPECT_EQ(solution.report.bilateral_rows, 1);
    EXPECT_LE(residual_of(problem, solution).eta, 1e-12);
  }
}

/// lambda = (c - v_free) / (1 / m + r), from soft to almost hard.
TEST(ContactBilateral, ACompliantRowIsASpring) {
  for (const double compliance : {1e3, 1.0, 1e-6, 1e-12}) {
    for (const ContactMethod method : methods) {
      ContactProblem problem = masses_on_a_line({2}, {3});
      add_links(problem, {{0, -1}});
      problem.bilateral.target = {0.5};
      problem.bilateral.compliance = {compliance};

      const ContactSolution solution =
          solve_contacts(problem, {.method = method, .tolerance = 1e-12});

      EXPECT_TRUE(solution.converged()) << solution.report.status_reason;
      const double lambda = (0.5 - 1.5) / (0.5 + compliance);
      EXPECT_NEAR(solution.bilateral_impulse[0], lambda, 1e-10 * std::abs(lambda));
      EXPECT_NEAR(solution.body_velocity[0], (3 + lambda) / 2, 1e-10);
      EXPECT_EQ(solution.body_velocity.size(), 1U);
      EXPECT_LE(residual_of(problem, solution).eta, 1e-11);
    }
  }
}

/// Masses that hang on each other over a floor that carries the lowest: every link carries what is
/// above it.
TEST(ContactBilateral, AColumnOfLinkedMassesStandsOnItsContact) {
  const int count = 30;
  for (const ContactMethod method : methods) {
    ContactProblem problem =
        masses_on_a_line(std::vector<double>(count, 1.0), std::vector<double>(count, -0.1));
    add_floor(problem, 0);
    std::vector<std::pair<int, int>> links;
    for (int i = 1; i < count; ++i) links.emplace_back(i, i - 1);
    add_links(problem, links);

    const ContactSolution solution = solve_contacts(problem, {.method = method, .tolerance = 1e-9});

    EXPECT_TRUE(solution.converged()) << solution.report.method << solution.report.status_reason;
    EXPECT_NEAR(solution.impulse[0], 0.1 * count, 1e-5);
    for (int i = 1; i < count; ++i) {
      EXPECT_NEAR(solution.bilateral_impulse[static_cast<std::size_t>(i - 1)], 0.1 * (count - i),
                  1e-5);
    }
  }
}

/// The same row in one group and in two: the velocity is unique, the impulses are shared.
TEST(ContactBilateral, RedundantRowsConverge) {
  for (const bool is_one_group : {true, false}) {
    for (const ContactMethod method : methods) {
      ContactProblem problem = masses_on_a_line({1, 3}, {2, -3});
      add_links(problem, {{0, 1}, {0, 1}, {1, 0}});
      if (is_one_group) problem.bilateral.group_start = {0, 3};

      const ContactSolution solution =
          solve_contacts(problem, {.method = method, .tolerance = 1e-10});

      EXPECT_TRUE(solution.converged()) << solution.report.method << solution.report.status_reason;
      EXPECT_NEAR(solution.body_velocity[0], -0.25, 1e-9);
      const std::vector<double>& lambda = solution.bilateral_impulse;
      EXPECT_NEAR(lambda[0] + lambda[1] - lambda[2], -2.25, 1e-8);
    }
  }
}

/// Contradicting joints: no velocity satisfies both.
TEST(ContactBilateral, ContradictingRowsDoNotConverge) {
  ContactProblem problem = masses_on_a_line({1}, {1});
  add_links(problem, {{0, -1}, {0, -1}});
  problem.bilateral.target = {0, 1};

  const ContactSolution solution = solve_contacts(problem, {.max_sweeps = 500});

  EXPECT_EQ(solution.report.status, ContactStatus::not_converged);
}

ContactProblem jointed_problem(std::uint32_t seed, double coupling) {
  ContactProblem problem = global_problem(seed, 5, coupling);
  add_bilateral_rows(problem, seed);
  return problem;
}

TEST(ContactBilateral, AgreesWithTheReference) {
  for (const double coupling : {0.0, 0.3}) {
    for (std::uint32_t seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(seed);
      expect_reference(jointed_problem(500 + seed, coupling), methods, 1e-6);
    }
  }
}

TEST(ContactBilateral, CoupledBodiesMayBeIterated) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    SCOPED_TRACE(seed);
    expect_iteration(jointed_problem(600 + seed, 0.3));
  }
}

TEST(ContactBilateral, StartsFromItsGuess) {
  ContactProblem problem = jointed_problem(700, 0);
  const ContactSolution solution = solve_contacts(problem, {.tolerance = 1e-9});
  problem.impulse_guess = solution.impulse;
  problem.bilateral.impulse_guess = solution.bilateral_impulse;

  const ContactSolution again = solve_contacts(problem, {.tolerance = 1e-8});

  EXPECT_TRUE(again.converged());
  EXPECT_EQ(again.report.sweeps, 0);
}

TEST(ContactBilateral, HasTheSameBitsForAnyThreadsAndSolvesInSeries) {
  const ContactProblem problem = jointed_problem(701, 0);
  ContactSolver solver({.threads = 1});
  const ContactSolution first = solver.solve(problem);

  expect_same_bits(solver.solve(problem), first, "again");
  expect_same_bits(solve_contacts(problem, {.threads = 3}), first, "threads");
}

TEST(ContactBilateral, IsRefusedInOneLine) {
  const struct {
    void (*spoil)(ContactProblem&);
    const char* text;
  } cases[] = {
      {[](ContactProblem& p) { p.bilateral.compliance[1] = -1; },
       "bilateral.compliance[1]: -1 is negative"},
      {[](ContactProblem& p) { p.bilateral.compliance[1] = INFINITY; },
       "bilateral.compliance[1]: inf is not finite"},
      {[](ContactProblem& p) { p.bilateral.compliance.pop_back(); },
       "bilateral.compliance: 5 entries, expected 6"},
      {[](ContactProblem& p) { p.bilateral.target[2] = NAN; },
       "bilateral.target[2]: nan is not finite"},
      {[](ContactProblem& p) {
         p.bilateral.group_start = {0, 4, 6};
       },
       "bilateral.group_start[1]: 4 makes a group of 4 rows"},
      {[](ContactProblem& p) {
         p.bilateral.group_start = {0, 3};
       },
       "bilateral.group_start[1]: 3, expected the number of rows, 6"},
      {[](ContactProblem& p) { p.bilateral.jacobian.columns = 7; }, "bilateral.jacobian"},
      {[](ContactProblem& p) {
         p.bilateral.jacobian.value.assign(p.bilateral.jacobian.value.size(), 0);
       },
       "bilateral.jacobian: row 0 is zero"},
      {[](ContactProblem& p) { p.expert.row_blocks.kind = {0}; }, "expert.row_blocks: not empty"}};
  for (const auto& [spoil, text] : cases) {
    ContactProblem problem = jointed_problem(702, 0);
    spoil(problem);

    const std::string message = message_of([&] { check_problem(problem); });

    EXPECT_NE(message.find(text), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  ContactProblem local = local_problem(703, 2);
  local.bilateral = jointed_problem(704, 0).bilateral;
  EXPECT_NE(message_of([&] { check_problem(local); }).find("take the global form"),
            std::string::npos);
  const ContactProblem problem = jointed_problem(705, 0);
  EXPECT_NE(message_of([&] {
              residual_of(problem, problem.impulse_guess, {});
            }).find("give the whole solution"),
            std::string::npos);
}
}  // namespace
}  // namespace tetwarp::test

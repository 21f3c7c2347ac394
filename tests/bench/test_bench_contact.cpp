/// @file test_bench_contact.cpp
/// The check of results in the contact benchmark, and the names of its rows.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include <tetwarp/contact.hpp>

#include "bench/contact/cases.hpp"
#include "bench/contact/solution_check.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::bench {
namespace {
/// A stack on two boxes, solved.
struct Solved {
  ContactProblem problem = scenes::box_stack({.boxes = 2});
  ContactOptions options = {.measure = ContactMeasure::fclib, .tolerance = 1e-8};
  ContactSolution solution = solve_contacts(problem, options);

  bool is_refused() const { return check_solution(problem, solution, options).fault.has_value(); }
};

TEST(BenchSolutionCheck, AcceptsWhatTheSolverReached) {
  const Solved solved;

  EXPECT_TRUE(solved.solution.converged());
  EXPECT_FALSE(solved.is_refused());
  EXPECT_LE(check_solution(solved.problem, solved.solution, solved.options).error, 1.01e-8);
}

TEST(BenchSolutionCheck, RefusesAnImpulseThatIsOff) {
  Solved solved;
  solved.solution.impulse[0] *= 1.001;

  EXPECT_TRUE(solved.is_refused());
}

TEST(BenchSolutionCheck, RefusesVelocitiesOfOtherBodies) {
  Solved solved;
  solved.solution.velocity[1] += 1e-6;

  EXPECT_TRUE(solved.is_refused());
}

TEST(BenchSolutionCheck, OfReportsUsesReportedErrorsAndChecksTheRest) {
  Solved solved;
  EXPECT_FALSE(check_report(solved.problem, solved.solution, solved.options).fault.has_value());
  EXPECT_EQ(check_report(solved.problem, solved.solution, solved.options).error,
            solved.solution.report.residual.fclib);

  solved.solution.velocity[1] += 1e-6;
  EXPECT_TRUE(check_report(solved.problem, solved.solution, solved.options).fault.has_value());
  solved.solution.velocity[1] -= 1e-6;
  solved.solution.report.residual.balance = 1e-6;
  EXPECT_TRUE(check_report(solved.problem, solved.solution, solved.options).fault.has_value());
}

/// Without friction a sliding box satisfies all contacts at any speed.
TEST(BenchSolutionCheck, RefusesAResultOutOfBalance) {
  Solved solved{.problem = scenes::box_stack({.boxes = 1, .friction = 0})};
  const double push = 0.01;
  solved.solution.body_velocity[0] += push;
  const SparseMatrix& jacobian = solved.problem.jacobian;
  for (std::size_t row = 0; row < solved.solution.velocity.size(); ++row) {
    const auto end = static_cast<std::size_t>(jacobian.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(jacobian.row_start[row]); e < end; ++e) {
      if (jacobian.column[e] == 0) solved.solution.velocity[row] += push * jacobian.value[e];
    }
  }

  EXPECT_TRUE(solved.is_refused());
}

TEST(BenchSolutionCheck, AcceptsAResultThatIsReportedAsNotConverged) {
  Solved solved;
  solved.options.max_sweeps = 1;
  solved.options.tolerance = 1e-14;
  solved.options.method = ContactMethod::gauss_seidel;
  solved.solution = solve_contacts(solved.problem, solved.options);

  EXPECT_FALSE(solved.solution.converged());
  EXPECT_FALSE(solved.is_refused());
}

TEST(BenchContactCases, HaveNamesOfTheirOwn) {
  for (const Extent extent : {Extent::brief, Extent::full}) {
    std::set<std::string> names;
    for (const ContactCase& row : contact_cases(extent, 2, "")) {
      EXPECT_TRUE(names.insert(name_of(row)).second) << name_of(row);
    }
    EXPECT_GT(names.size(), 50u);
  }
}
}  // namespace
}  // namespace tetwarp::bench

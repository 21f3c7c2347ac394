/// @file truth.hpp
/// Checks of a status by the reference, which shares no code with the solver.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include <tetwarp/contact.hpp>

#include "host/reference/contact/dense.hpp"
#include "tests/support/solvability.hpp"

namespace tetwarp::test {
/// eta of the reference, which shares no code with the solver.
inline double reference_eta(const ContactProblem& problem,
                            const ContactSolution& solution,
                            const ContactOptions& options) {
  const reference::DenseContacts dense = reference::make_dense(problem, options.recovery_speed);
  return reference::eta_of(dense, samples::vector_of(solution.impulse), options);
}

/// Solves a problem of make_solvability() and checks that its status is true.
inline void expect_truth(const ContactProblem& problem,
                         samples::Solvability kind,
                         const ContactOptions& options,
                         const std::string& name) {
  const ContactSolution solution = solve_contacts(problem, options);
  for (const double r : solution.impulse) EXPECT_LT(std::abs(r), 1e12) << name;
  EXPECT_EQ(solution.report.status_reason.empty(), solution.converged()) << name;
  if (solution.converged()) {
    EXPECT_LE(reference_eta(problem, solution, options), 2 * options.tolerance) << name;
    EXPECT_NE(kind, samples::Solvability::infeasible) << name;
  }
  if (kind == samples::Solvability::infeasible) {
    EXPECT_EQ(solution.report.status, ContactStatus::infeasible)
        << name << ": " << solution.report.status_reason;
  }
  if (kind == samples::Solvability::solvable) {
    EXPECT_NE(solution.report.status, ContactStatus::infeasible)
        << name << ": " << solution.report.status_reason;
  }
}

}  // namespace tetwarp::test

/// @file solution_check.hpp
/// Checks whether the result of a contact solver has the accuracy that the solver reports.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/contact.hpp>

namespace tetwarp::bench {

/// The error that the tolerance bounds: FCLIB's where nothing adheres, because other solvers report
/// it too; else eta.
ContactMeasure measure_of(const ContactProblem& problem);

/// The errors of a result.
struct SolutionCheck {
  ContactResidual residual;
  double error = 0;                  ///< eta or FCLIB's, the one that the tolerance bounds
  std::optional<std::string> fault;  ///< why the result is wrong
};

/// A result is wrong when the contact velocities do not follow from the bodies' velocities or the
/// impulses, or when its status is converged although its error, or the imbalance of
/// A v = J^T r + b, is above the tolerance. A result with another status is never wrong for its
/// error. Errors are computed by residual_of().
SolutionCheck check_solution(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const ContactOptions& options);

/// The same from the errors that the solver reports, without a factorization of A. Used once
/// check_solution() has accepted a result of the same method on the same problem.
SolutionCheck check_report(const ContactProblem& problem,
                           const ContactSolution& solution,
                           const ContactOptions& options);

}  // namespace tetwarp::bench

/// @file contact_judge.hpp
/// Says whether a contact solver's result is what the solver calls it.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/contact.hpp>

namespace tetwarp::bench {

/// What the tolerance bounds: FCLIB's error where nothing adheres, as other solvers know it; eta
/// else.
ContactMeasure measure_of(const ContactProblem& problem);

/// A result's errors, as residual_of() finds them.
struct ContactJudgement {
  ContactResidual residual;
  double error = 0;                  ///< the one of both that the tolerance bounds
  std::optional<std::string> fault;  ///< why the result is wrong
};

/// A result is wrong when the velocities at the contacts are not those of the bodies or impulses,
/// or when it calls itself converged although its error, or the imbalance of A v = J^T r + b, is
/// above the tolerance. One that says that it did not converge is no wrong one.
ContactJudgement judge(const ContactProblem& problem,
                       const ContactSolution& solution,
                       const ContactOptions& options);

/// The same from the errors that the solver reports, which takes no factorization of A: for the
/// results of a method that judge() has looked at on this problem.
ContactJudgement judge_report(const ContactProblem& problem,
                              const ContactSolution& solution,
                              const ContactOptions& options);

}  // namespace tetwarp::bench

#include "bench/contact/solution_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace tetwarp::bench {
namespace {
/// Largest difference between u and J v + w, or W r + q, relative to the largest term.
double velocity_mismatch(const ContactProblem& problem, const ContactSolution& solution) {
  const bool is_local = problem.is_local();
  const SparseMatrix& matrix = is_local ? problem.delassus : problem.jacobian;
  const std::vector<double>& x = is_local ? solution.impulse : solution.body_velocity;
  const std::vector<double>& offset = is_local ? problem.free_velocity : problem.velocity_offset;
  double mismatch = 0, scale = 0;
  for (std::size_t row = 0; row < offset.size(); ++row) {
    double u = offset[row];
    scale = std::max(scale, std::abs(u));
    const auto end = static_cast<std::size_t>(matrix.row_start[row + 1]);
    for (auto e = static_cast<std::size_t>(matrix.row_start[row]); e < end; ++e) {
      const double term = matrix.value[e] * x[static_cast<std::size_t>(matrix.column[e])];
      scale = std::max(scale, std::abs(term));
      u += term;
    }
    mismatch = std::max(mismatch, std::abs(u - solution.velocity[row]));
  }
  return scale > 0 ? mismatch / scale : mismatch;
}

SolutionCheck check_residual(const ContactResidual& residual,
                             const ContactProblem& problem,
                             const ContactSolution& solution,
                             const ContactOptions& options) {
  SolutionCheck check;
  check.residual = residual;
  const bool by_eta = options.measure == ContactMeasure::eta;
  check.error = by_eta ? residual.eta : residual.fclib;
  // Solver and check round differently: 1 % of the tolerance, and float64 sums of large terms.
  if (solution.converged() && !(check.error <= 1.01 * options.tolerance + 1e-13)) {
    check.fault = fmt::format("called converged at {:.0e}, but its error is {:.2e}",
                              options.tolerance, check.error);
  }
  if (solution.converged() && !(residual.balance <= options.tolerance)) {
    check.fault = fmt::format("momentum is out of balance by {:.1e}", residual.balance);
  }
  const double mismatch = velocity_mismatch(problem, solution);
  if (!(mismatch <= 1e-10)) {
    check.fault = fmt::format("contact velocities are off by {:.1e}", mismatch);
  }
  return check;
}
}  // namespace

ContactMeasure measure_of(const ContactProblem& problem) {
  return problem.adhesion.empty() ? ContactMeasure::fclib : ContactMeasure::eta;
}

SolutionCheck check_solution(const ContactProblem& problem,
                             const ContactSolution& solution,
                             const ContactOptions& options) {
  return check_residual(residual_of(problem, solution, options), problem, solution, options);
}

SolutionCheck check_report(const ContactProblem& problem,
                           const ContactSolution& solution,
                           const ContactOptions& options) {
  return check_residual(solution.report.residual, problem, solution, options);
}

}  // namespace tetwarp::bench

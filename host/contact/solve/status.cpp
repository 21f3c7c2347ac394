/// @file status.cpp
/// Sums residuals over islands, and says why a solve has ended.
#include "host/contact/solve/status.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>
#include <string>

namespace tetwarp {
namespace {
std::string rounded_text_of(double value) {
  std::ostringstream text;
  text << std::setprecision(2) << value;
  return text.str();
}

/// "impulse[3] is not finite" for the first such number, or empty.
std::string first_not_finite(const ContactSolution& solution) {
  const auto find = [](const char* name, const std::vector<double>& values) -> std::string {
    const auto found = std::find_if(values.begin(), values.end(),
                                    [](double value) { return !std::isfinite(value); });
    if (found == values.end()) return {};
    return std::string(name) + "[" + std::to_string(found - values.begin()) + "] is not finite";
  };
  std::string text = find("impulse", solution.impulse);
  if (text.empty()) text = find("body_velocity", solution.body_velocity);
  if (text.empty()) text = find("velocity", solution.velocity);
  return text;
}

/// Why a solution is not within the tolerance; empty: it is.
std::string reason_of(const WholeResidual& whole,
                      const ContactOptions& options,
                      const ContactSolution& solution) {
  const ContactReport& report = solution.report;
  const bool by_eta = options.measure == ContactMeasure::eta;
  const double residual = by_eta ? report.residual.eta : report.residual.fclib;
  const std::string name = by_eta ? "eta" : "FCLIB error";
  const std::string limit = ", tolerance " + rounded_text_of(options.tolerance);
  constexpr double rounding = 1e-10;  // relative, of A v where A is ill-conditioned
  std::string text = first_not_finite(solution);
  if (!text.empty()) return text;
  if (!std::isfinite(residual)) {
    return name + " is not finite: a square of the problem's numbers overflows";
  }
  if (!(residual <= options.tolerance)) {
    return name + " is " + rounded_text_of(residual) + " after " + std::to_string(report.sweeps) +
           " sweeps" + limit;
  }
  if (!(report.residual.balance <= std::max(options.tolerance, rounding))) {
    return "relative residual of A v = J^T r + b is " + rounded_text_of(report.residual.balance) +
           limit;
  }
  if (by_eta && !(whole.resolution() <= options.tolerance)) {
    return "rounding of the impulses limits eta to " + rounded_text_of(whole.resolution()) + limit;
  }
  return {};
}
}  // namespace

WholeResidual whole_residual(const std::vector<IslandOutcome>& outcomes) {
  WholeResidual whole;
  for (const IslandOutcome& outcome : outcomes) {
    whole.sums += outcome.sums;
    whole.free += outcome.free;
    whole.free_square += outcome.free_square;
  }
  return whole;
}

void set_status(const EngineResult& result,
                const WholeResidual& whole,
                const ContactOptions& options,
                const SolveBudget& budget,
                ContactSolution& solution) {
  ContactReport& report = solution.report;
  report.status_reason = reason_of(whole, options, solution);
  if (!result.clamped.empty()) {
    report.status = ContactStatus::infeasible;
    report.status_reason =
        "no velocity satisfies contact " + std::to_string(result.clamped.front()) +
        " together with " + std::to_string(result.clamped.size() - 1) +
        " others; the solution and its residual are those with their normal offsets raised to 0";
    if (result.clamped_speed > 0) {
      report.status_reason +=
          "; certified: a combination of their normals that no velocity "
          "changes approaches at " +
          rounded_text_of(result.clamped_speed) + " m/s";
    }
    return;
  }
  report.status =
      report.status_reason.empty() ? ContactStatus::converged : ContactStatus::not_converged;
  if (report.status == ContactStatus::converged) return;
  if (!result.unbounded.empty()) {
    report.status = ContactStatus::unbounded;
    report.status_reason += "; impulses of contact " + std::to_string(result.unbounded.front()) +
                            " together with " + std::to_string(result.unbounded.size() - 1) +
                            " others can grow without bound: they cancel, and against them the "
                            "contacts approach at " +
                            rounded_text_of(result.unbounded_speed) + " m/s";
  }
  const std::string limit = budget.reason();
  if (!limit.empty()) report.status_reason += "; " + limit;
}

}  // namespace tetwarp

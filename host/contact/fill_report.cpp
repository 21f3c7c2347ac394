/// @file fill_report.cpp
/// Sums the outcomes of the islands and joins their histories.
#include "host/contact/fill_report.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tetwarp {
namespace {
/// The residual of the whole problem at each sweep at which any island was measured, of each island
/// the last error measured up to that sweep.
/// @param scale  divides the root of the summed squares of the errors
std::vector<double> merged_history(const std::vector<IslandOutcome>& outcomes, double scale) {
  struct Step {
    std::int64_t sweep;
    std::size_t island;
    double square;
  };
  std::vector<Step> steps;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    for (const ContactEvent& event : outcomes[i].events) {
      steps.push_back({event.sweep, i, event.error * event.error});
    }
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.sweep < b.sweep; });
  // A binary tree of sums with its root at 1. Updating one running sum by differences would leave
  // the rounding errors of the first, large squares in the last, small ones.
  std::vector<double> sums(2 * outcomes.size(), 0.0);
  std::vector<double> history;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    std::size_t node = outcomes.size() + steps[k].island;
    sums[node] = steps[k].square;
    for (node /= 2; node > 0; node /= 2) sums[node] = sums[2 * node] + sums[2 * node + 1];
    if (k + 1 < steps.size() && steps[k + 1].sweep == steps[k].sweep) continue;
    history.push_back(std::sqrt(sums[1]) / std::max(scale, 1e-300));
  }
  return history;
}

void count_outcomes(const std::vector<IslandOutcome>& outcomes, ContactReport& report) {
  std::vector<std::string> methods;
  for (const IslandOutcome& outcome : outcomes) {
    report.sweeps = std::max(report.sweeps, outcome.sweeps);
    report.outer_iterations = std::max(report.outer_iterations, outcome.outer_iterations);
    report.multiplier_steps += outcome.multiplier_steps;
    report.newton_iterations += outcome.newton_iterations;
    report.contact_updates += outcome.contact_updates;
    for (const char* method : outcome.methods) {
      if (std::find(methods.begin(), methods.end(), method) == methods.end()) {
        methods.emplace_back(method);
      }
    }
  }
  for (const IslandOutcome& outcome : outcomes) {
    if (outcome.sweeps < report.sweeps) ++report.islands_stopped;
  }
  for (const std::string& method : methods) {
    report.method += (report.method.empty() ? "" : ", ") + method;
  }
}
}  // namespace

void fill_report(const EngineResult& result,
                 const WholeResidual& whole,
                 ContactMeasure measure,
                 ContactReport& report) {
  report.colors = result.colors;
  report.islands = static_cast<std::int64_t>(result.outcomes.size());
  report.rows_skipped = result.savings.rows;
  report.springs_skipped = result.savings.springs;
  report.bodies_skipped = result.bodies_skipped;
  report.updates_skipped = result.updates_skipped;
  report.condensations_kept = result.condensations_kept;
  count_outcomes(result.outcomes, report);
  report.contact_updates -= result.updates_skipped;

  report.residual.eta = whole.eta();
  report.residual.fclib = whole.fclib();
  report.residual.largest = whole.eta_of(whole.sums.largest);
  report.residual.largest_contact = whole.sums.largest_contact;
  report.residual.penetration = whole.sums.deepest;
  const bool by_eta = measure == ContactMeasure::eta;
  const double error = std::sqrt(by_eta ? whole.sums.eta : whole.sums.fclib);
  const double residual = by_eta ? whole.eta() : whole.fclib();
  const bool has_scale = residual > 0 && std::isfinite(residual);
  report.residual_history = merged_history(result.outcomes, has_scale ? error / residual : 1);
}

}  // namespace tetwarp

#include "bench/contact/rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "bench/contact/solution_check.hpp"
#include "bench/measure/row.hpp"

namespace tetwarp::bench {
namespace {
/// The problem of a row. Rows of one problem follow each other, so only the last one is kept.
const ContactProblem& problem_of(const ContactInput& input) {
  static std::string name;
  static ContactProblem problem;
  if (name != input.name) {
    problem = input.make();
    name = input.name;
  }
  return problem;
}

ContactOptions options_of(const ContactCase& row, const ContactProblem& problem) {
  ContactOptions options = row.options;
  if (row.kind != ContactKind::method) options.measure = measure_of(problem);
  options.max_sweeps =
      std::clamp<std::int64_t>(row.max_updates / std::max<std::int64_t>(problem.contact_count(), 1),
                               100, options.max_sweeps);
  return options;
}

/// Solves a case as its ContactVisit states and keeps the last result.
class Subject {
 public:
  Subject(const ContactCase& row, const ContactProblem& problem)
      : visit_(row.visit), options_(options_of(row, problem)), steps_{problem} {
    if (visit_ == ContactVisit::first) return;
    ContactProblem next = problem;
    for (double& impulse : next.load) impulse *= 1.01;
    steps_.push_back(std::move(next));
    solver_.emplace(options_);
    for (std::size_t k = 0; k < steps_.size(); ++k) solve();
  }

  void solve() {
    if (visit_ == ContactVisit::first) solver_.emplace(options_);
    at_ = (at_ + 1) % steps_.size();
    ContactProblem& problem = steps_[at_];
    if (visit_ == ContactVisit::warm) problem.impulse_guess = solution_.impulse;
    solution_ = solver_->solve(problem);
  }

  const ContactProblem& problem() const { return steps_[at_]; }
  const ContactSolution& solution() const { return solution_; }
  const ContactOptions& options() const { return options_; }

 private:
  ContactVisit visit_;
  ContactOptions options_;
  std::vector<ContactProblem> steps_;  ///< solved in turn
  std::size_t at_ = 0;
  std::optional<ContactSolver> solver_;
  ContactSolution solution_;
};

void count_report(benchmark::State& state, const ContactReport& report) {
  auto& counters = state.counters;
  counters["setup"] = 1e3 * report.setup_seconds;
  counters["solve"] = 1e3 * report.solve_seconds;
  const std::pair<const char*, std::int64_t> counts[] = {
      {"contacts", report.contacts},
      {"colors", report.colors},
      {"islands", report.islands},
      {"sweeps", report.sweeps},
      {"outer_iterations", report.outer_iterations},
      {"newton_iterations", report.newton_iterations},
      {"updates", report.contact_updates},
      {"rows_skipped", report.rows_skipped},
      {"springs_skipped", report.springs_skipped},
      {"bodies_skipped", report.bodies_skipped},
      {"islands_stopped", report.islands_stopped},
      {"updates_skipped", report.updates_skipped}};
  for (const auto& [name, count] : counts) counters[name] = static_cast<double>(count);
  counters["updates_per_second"] =
      static_cast<double>(report.contact_updates) / std::max(report.solve_seconds, 1e-9);
}

void count_check(benchmark::State& state, const Subject& subject, const SolutionCheck& check) {
  state.counters["converged"] = subject.solution().converged() ? 1 : 0;
  state.counters["eta"] = check.residual.eta;
  state.counters["fclib"] = check.residual.fclib;
  state.counters["penetration"] = check.residual.penetration;
  state.counters["error"] = check.error;
}

/// The part of the name that rows of one method on one problem share.
std::string line_of(ContactCase row) {
  row.options.tolerance = 1;
  return name_of(row);
}

/// Long solves are repeated less often. Of the many rows of all methods the least processor time
/// counts, so that few repetitions suffice.
Protocol protocol_for(ContactKind kind, double first_seconds) {
  const double seconds = kind == ContactKind::method ? 0.05 : 0.5;
  const int repetitions =
      std::clamp(static_cast<int>(seconds / std::max(first_seconds, 1e-9)), 1, 9);
  return {.repetitions = repetitions, .attempts = 3 * repetitions, .seconds = seconds};
}

void run(benchmark::State& state, const ContactCase& row) {
  static std::set<std::string> checked;
  static std::set<std::string> given_up;  // methods that have missed a tolerance
  if (given_up.contains(line_of(row))) {
    state.SkipWithError("left out: a looser tolerance was not reached");
    return;
  }
  const ContactProblem& problem = problem_of(row.input);
  if (row.options.rule == AdhesionRule::restrictive && problem.adhesion.empty()) {
    state.SkipWithError("left out: the rules do not differ");
    return;
  }
  Subject subject(row, problem);
  const double first_seconds = seconds_of([&] { subject.solve(); });
  const bool is_known = !checked.insert(line_of(row)).second && row.kind != ContactKind::method;
  const SolutionCheck check = (is_known ? check_report : check_solution)(
      subject.problem(), subject.solution(), subject.options());
  if (check.fault) return refuse(state, *check.fault);
  if (!subject.solution().converged()) given_up.insert(line_of(row));
  const std::function<void()> job = [&] { subject.solve(); };
  const Timing timing =
      time_in_turn(std::span(&job, 1), protocol_for(row.kind, first_seconds)).front();
  count_timing(state, timing);
  state.counters["processor"] = 1e3 * timing.processor;
  count_report(state, subject.solution().report);
  count_check(state, subject, check);
}
}  // namespace

void add_contact_row(const ContactCase& row) {
  add_row(name_of(row), [row](benchmark::State& state) { run(state, row); });
}

}  // namespace tetwarp::bench

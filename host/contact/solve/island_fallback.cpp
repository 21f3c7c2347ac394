/// @file island_fallback.cpp
/// What follows on an island where the first sweeps have not converged.
#include <algorithm>
#include <limits>
#include <optional>

#include "host/contact/newton/newton.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/solve/best_impulses.hpp"
#include "host/contact/solve/certificate.hpp"
#include "host/contact/solve/island_solver.hpp"
#include "host/contact/solve/method_choice.hpp"
#include "host/contact/structure/extract.hpp"
#include "host/contact/sweeps/method_names.hpp"

namespace tetwarp {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
/// Newton steps that an island is expected to take, and those that the phases of a trial share out.
/// Stacks and jams take some ten, packings with friction hundreds.
struct NewtonTrial {
  std::int64_t expected;
  std::int64_t shared;
};
constexpr NewtonTrial newton_trials[] = {{40, 60}, {200, 400}};
/// A trial takes at most as long as the sweeps before it, so that sweeps which would have converged
/// without it take at most twice as long; but it may take this many steps in any case.
constexpr std::int64_t short_trial = 40;

/// Whether a certificate may be searched for: it costs up to 60 factorizations, which other methods
/// than Newton's take only where many sweeps are allowed, too.
bool searches_certificates(const ContactOptions& options) {
  return options.method == ContactMethod::automatic || options.method == ContactMethod::newton ||
         options.max_sweeps >= 4096;
}

/// The contacts of an island that a direction of impulses pushes.
std::vector<std::int32_t> contacts_of(const ImpulseDirection& direction,
                                      const ContactStructure& structure,
                                      const ContactIsland& island) {
  std::vector<std::int32_t> contacts;
  for (std::int64_t c = 0; c < island.contact_count(); ++c) {
    if (!(direction.impulse[index_of(3 * c)] > 1e-6)) continue;
    contacts.push_back(structure.contact_of_slot[index_of(island.slot_begin + c)]);
  }
  return contacts;
}

/// Whether an island has blocks of rows that are no contacts.
bool has_other_blocks(const ContactProblem& problem,
                      const ContactStructure& structure,
                      const ContactIsland& island) {
  if (problem.row_blocks.empty()) return false;
  for (std::int64_t s = island.slot_begin; s < island.slot_end; ++s) {
    const std::int32_t c = structure.contact_of_slot[index_of(s)];
    if (!is_contact_block(problem, index_of(c))) return true;
  }
  return false;
}
}  // namespace

void IslandSolver::fall_back(std::int64_t island, ContactRun<double>& run, EngineResult& result) {
  IslandOutcome& outcome = result.outcomes[index_of(island)];
  if (budget_ != nullptr && budget_->is_over()) return;
  if (has_other_blocks(*problem_, structure_, structure_.islands[index_of(island)])) {
    continue_with_rows(island, run, result);
    return;
  }
  const bool is_automatic = options_.method == ContactMethod::automatic;
  const ContradictionSearch full{std::min<std::int64_t>(options_.max_sweeps, 4096), false};
  if (!is_automatic && options_.method != ContactMethod::newton) {
    if (clamp_contradicting(island, run, full, result) || !searches_certificates(options_)) return;
    const ContactProblem part =
        make_island_problem(*problem_, structure_, structure_.islands[index_of(island)]);
    if (!find_contradiction(island, part, result)) find_unbounded(island, part, result);
    return;
  }
  const ContradictionSearch brief{
      std::min(full.max_sweeps, std::max<std::int64_t>(outcome.sweeps, 64)), true};
  if (clamp_contradicting(island, run, brief, result)) return;
  const ContactProblem part =
      make_island_problem(*problem_, structure_, structure_.islands[index_of(island)]);
  std::vector<double> last;
  if (is_automatic) {
    const double step = sweeps_per_step(part);
    for (const NewtonTrial& trial : newton_trials) {
      const std::int64_t steps = std::min(trial.expected, max_newton_steps(part.contact_count()));
      sweep_while_cheaper(island, run, outcome, static_cast<double>(steps) * step, last);
      if (run.is_done(island, outcome.sums)) return;
      const auto affordable = static_cast<std::int64_t>(static_cast<double>(outcome.sweeps) / step);
      polish(island, part, run, outcome, {trial.shared, std::max(short_trial, affordable)});
      if (run.is_done(island, outcome.sums)) return;
    }
  } else {
    polish(island, part, run, outcome, {});
    if (run.is_done(island, outcome.sums)) return;
  }
  if (clamp_contradicting(island, run, full, result)) return;
  if (find_contradiction(island, part, result)) return;
  bool is_searched = false;
  if (is_automatic) {
    is_searched = searches_before_sweeps(part, outcome);
    const bool is_unbounded = is_searched && find_unbounded(island, part, result);
    if (is_unbounded) {
      start_again(island, part, run, outcome);
      last.clear();
    }
    if (!run.is_done(island, outcome.sums)) {
      sweep_while_cheaper(island, run, outcome, infinity, last);
    }
    double before = infinity;
    while (!run.is_done(island, outcome.sums) && run.excess(island, outcome.sums) < before / 2) {
      before = run.excess(island, outcome.sums);
      polish(island, part, run, outcome, {});  // each better start may converge
    }
  }
  if (!is_searched && !run.is_done(island, outcome.sums)) find_unbounded(island, part, result);
}

/// fall_back() for an island with bilateral or rolling blocks: no certificates, and no Newton's
/// method where there is rolling friction, which it does not have.
void IslandSolver::continue_with_rows(std::int64_t island,
                                      ContactRun<double>& run,
                                      EngineResult& result) {
  IslandOutcome& outcome = result.outcomes[index_of(island)];
  const bool is_automatic = options_.method == ContactMethod::automatic;
  const bool has_newton =
      (is_automatic || options_.method == ContactMethod::newton) && !has_rolling(*problem_);
  const ContactProblem part =
      make_island_problem(*problem_, structure_, structure_.islands[index_of(island)]);
  for (const bool is_first : {true, false}) {
    if (has_newton) {
      polish(island, part, run, outcome,
             is_automatic && is_first ? NewtonLimits{.shared = newton_trials[1].shared}
                                      : NewtonLimits{});
    }
    if (!is_first || !is_automatic || run.is_done(island, outcome.sums)) return;
    run.sweep_on(island, options_.max_sweeps);
    outcome.sums = run.measure(island);
    if (run.is_done(island, outcome.sums)) return;
  }
}

/// Continues with sweeps until Newton's method promises to be cheaper; see method_choice.hpp.
/// Leaves the best impulses. The next sweeps continue from the last ones: near impulses of a small
/// residual that are no solution the residual first grows, and sweeps from the best ones would
/// return there.
/// @param newton_sweeps  sweeps that take as long as Newton's method would
/// @param last           in: where to continue, empty: the current impulses; out: the last ones
void IslandSolver::sweep_while_cheaper(std::int64_t i,
                                       ContactRun<double>& run,
                                       IslandOutcome& outcome,
                                       double newton_sweeps,
                                       std::vector<double>& last) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  double* const impulse = run.state().impulse.data() + 3 * island.slot_begin;
  const std::int64_t size = 3 * island.contact_count();
  BestImpulses best(impulse, size, run.excess(i, outcome.sums));
  std::copy(last.begin(), last.end(), impulse);
  while (outcome.sweeps < options_.max_sweeps && !(budget_ != nullptr && budget_->is_over())) {
    const double before = best.excess();
    const std::int64_t from = outcome.sweeps;
    const double least = run.sweep_past_best(i, from + std::max<std::int64_t>(64, from / 2));
    outcome.sums = run.measure(i);
    if (run.is_done(i, outcome.sums)) return;
    best.keep(run.best_impulse(i), least);
    const std::int64_t sweeps = outcome.sweeps - from;
    if (sweeps == 0) break;  // numbers are not finite
    const double left = sweeps_left(before, best.excess(), sweeps);
    if (prefers_newton(newton_sweeps, outcome.sweeps, left)) break;
  }
  last.assign(impulse, impulse + size);
  best.restore();
  outcome.sums = run.measure(i);
}

/// Sweeps that take as long as a step of Newton's method; infinity where it may not be used.
double IslandSolver::sweeps_per_step(const ContactProblem& part) const {
  const double memory = budget_ != nullptr ? budget_->memory_limit() : infinity;
  const NewtonCost cost = newton_cost(part, memory);
  if (cost.bytes > memory || options_.max_newton == 0) return infinity;
  return sweeps_per_newton_step(cost, part.contact_count());
}

/// @return  whether normal offsets that sweeps show to contradict each other were noted
bool IslandSolver::clamp_contradicting(std::int64_t island,
                                       const ContactRun<double>& run,
                                       ContradictionSearch search,
                                       EngineResult& result) {
  for (const std::int64_t slot :
       contradicting_slots(structure_, run.system(), structure_.islands[index_of(island)], search,
                           contradiction_memory_, budget_)) {
    result.clamped.push_back(structure_.contact_of_slot[index_of(slot)]);
  }
  return !result.clamped.empty();
}

/// Searches for a certificate that normal offsets contradict each other. Sweeps, which come first,
/// need about the square of the number of bodies in a chain to show it.
bool IslandSolver::find_contradiction(std::int64_t i,
                                      const ContactProblem& part,
                                      EngineResult& result) {
  const std::optional<ImpulseDirection> found =
      find_direction(part, options_, DirectionCone::normals, budget_);
  if (!found) return false;
  result.clamped_speed = found->speed;
  result.clamped = contacts_of(*found, structure_, structure_.islands[index_of(i)]);
  return true;
}

bool IslandSolver::find_unbounded(std::int64_t i,
                                  const ContactProblem& part,
                                  EngineResult& result) {
  const std::optional<ImpulseDirection> found =
      find_direction(part, options_, DirectionCone::friction, budget_);
  if (!found) return false;
  result.unbounded_speed = found->speed;
  result.unbounded = contacts_of(*found, structure_, structure_.islands[index_of(i)]);
  return true;
}

/// Newton's method from the current impulses; keeps its impulses unless their error is larger.
/// @param part  the island as a problem
void IslandSolver::polish(std::int64_t i,
                          const ContactProblem& part,
                          ContactRun<double>& run,
                          IslandOutcome& outcome,
                          const NewtonLimits& limits) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  ContactOptions options = options_;
  options.tolerance /= 2;  // relative to this island, not to the whole problem
  double* const impulse = run.state().impulse.data() + 3 * island.slot_begin;
  std::vector<double> polished(impulse, impulse + 3 * island.contact_count()), body_velocity;
  const std::vector<double> swept = polished;
  const NewtonResult newton =
      newton_polish(part, options, polished, body_velocity, budget_, limits);
  outcome.newton_iterations += newton.iterations;
  if (newton.iterations > 0) outcome.methods.push_back(report_name_of(ContactMethod::newton));
  const double before = run.excess(i, outcome.sums);
  std::copy(polished.begin(), polished.end(), impulse);
  if (run.excess(i, run.measure(i)) > before) std::copy(swept.begin(), swept.end(), impulse);
  outcome.sums = run.measure(i);
}

}  // namespace tetwarp

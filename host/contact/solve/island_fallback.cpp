/// @file island_fallback.cpp
/// The order of the methods, and the costs by which they take turns.
#include "host/contact/solve/island_fallback.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "host/contact/newton/augmented_lagrangian.hpp"
#include "host/contact/newton/newton.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/solve/best_impulses.hpp"
#include "host/contact/solve/certificate.hpp"
#include "host/contact/solve/island_restart.hpp"

namespace tetwarp {
namespace {
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t search_sweeps = 4096;  ///< of a search for contradictions, at most
/// Sweeps before the choice of a method: where the method of multipliers can follow, and elsewhere.
constexpr std::int64_t short_sweeps = 24, usual_sweeps = 64;
/// A series of Newton steps between sweeps.
struct NewtonTrial {
  double expected;  ///< steps by which sweeps count its cost
  NewtonLimits limits;
};
constexpr NewtonTrial newton_trials[] = {
    {12, {.shared = 160, .total = 40, .phases = NewtonPhases::near}},
    {60, {.shared = 60, .total = 40, .phases = NewtonPhases::far}}};
/// Factorizations that the method of multipliers usually takes.
constexpr double multiplier_steps = 12;
/// Sweeps that the first trial takes as long as at least. As long as more sweeps promise to be
/// cheaper, neither contradictions nor the cost of a factorization are looked for.
constexpr double least_trial = 240;

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
}  // namespace

/// Whether the search for a direction costs less than the sweeps that are left, or than a few
/// thousand.
bool IslandFallback::searches_before_sweeps() {
  constexpr double factorizations = 60;
  constexpr std::int64_t few = 4096;
  if (attempt_.options().max_newton == 0 || has_other_blocks()) return false;
  const double step = attempt_.sweeps_per_newton_step();
  const std::int64_t left = std::max(attempt_.max_sweeps() - attempt_.outcome().sweeps, few);
  return factorizations * step < static_cast<double>(left);
}

/// Whether the island has blocks of rows that are no contacts.
bool IslandFallback::has_other_blocks() const {
  if (attempt_.problem().expert.row_blocks.empty()) return false;
  for (std::int64_t s = attempt_.island().slot_begin; s < attempt_.island().slot_end; ++s) {
    const std::int32_t c = attempt_.structure().contact_of_slot[index_of(s)];
    if (!is_contact_block(attempt_.problem(), index_of(c))) return true;
  }
  return false;
}

bool IslandFallback::takes_multipliers(const HostProblem& all, std::int64_t i) {
  const ContactIsland& island = all.structure.islands[index_of(i)];
  return all.options.method == ContactMethod::automatic && !island.is_coupled &&
         tetwarp::takes_multipliers(all.problem, all.options, island.dof_end - island.dof_begin);
}

/// Of larger problems all sweeps come first: several threads share their islands.
std::int64_t IslandFallback::first_sweeps(const HostProblem& all, std::int64_t i) {
  constexpr std::int64_t few_contacts = 512;
  const bool is_short = all.problem.contact_count() <= few_contacts && takes_multipliers(all, i);
  return is_short ? short_sweeps : all.options.max_sweeps;
}

/// Sweeps as long as they promise to be cheaper, then the method of multipliers. Where that fails
/// after few sweeps, all sweeps that other islands have follow; where these came first, they do not
/// come again.
void IslandFallback::try_multipliers() {
  const bool is_short = attempt_.outcome().sweeps <= short_sweeps;
  const ContactIsland& island = attempt_.island();
  const std::vector<ContactEvent>& events = attempt_.outcome().events;
  if (events.size() > 1) {
    const auto least = std::ranges::min_element(events, {}, &ContactEvent::error);
    const double first = attempt_.excess() * events.front().error / least->error;
    left_ = sweeps_left(first, attempt_.excess(), attempt_.outcome().sweeps);
  }
  if (is_short) sweeps_ = SweepChoice(ContactMethod::anderson);
  const std::int64_t dofs = island.dof_end - island.dof_begin;
  const double step = sweeps_per_multiplier_step(dofs, island.contact_count());
  sweep_while_cheaper(multiplier_steps * step, short_sweeps);
  if (!attempt_.is_done()) attempt_.solve_by_multipliers();
  if (!attempt_.is_done() && is_short) sweep_from_guess();
}

/// All that other islands have first, as if nothing had been tried: Newton's method after other
/// sweeps may take several times as many steps.
void IslandFallback::sweep_from_guess() {
  double* const impulse = attempt_.impulse();
  const std::vector<double>& guess = attempt_.part().impulse_guess;
  BestImpulses best(impulse, attempt_.size(), attempt_.excess());
  std::fill_n(impulse, attempt_.size(), 0.0);
  std::ranges::copy(guess, impulse);
  attempt_.abandon_sweeps();
  const double swept = attempt_.run().sweep_past_best(attempt_.index(), attempt_.max_sweeps(),
                                                      ContactMethod::automatic);
  attempt_.measure();
  sweeps_ = SweepChoice();
  left_ = 0;
  if (attempt_.is_done()) return;
  best.keep(attempt_.run().best_impulse(attempt_.index()), swept);
  last_.assign(impulse, impulse + attempt_.size());
  best.restore();
  attempt_.measure();
}

void IslandFallback::run() {
  run_methods();
  attempt_.add_abandoned();
}

void IslandFallback::run_methods() {
  const std::int64_t most = std::min(attempt_.max_sweeps(), search_sweeps);
  constexpr std::int64_t few = 64;
  if (attempt_.is_over()) return;
  if (!has_newton()) {
    const bool allows_many = attempt_.max_sweeps() >= search_sweeps;
    if (!clamp_contradicting({most, false}) && allows_many) certify_after_sweeps();
    return;
  }
  if (is_automatic()) {
    if (takes_multipliers(attempt_.all(), attempt_.index())) try_multipliers();
    if (!attempt_.is_done()) sweep_while_cheaper(least_trial, usual_sweeps);
  }
  if (attempt_.is_done() || clamp_contradicting({std::min(most, few), true})) return;
  is_automatic() ? take_turns() : attempt_.polish({});
  if (attempt_.is_done() || clamp_contradicting({most, false}) || find_contradiction()) return;
  if (is_automatic()) {
    finish_automatic();
  } else {
    find_unbounded();
  }
}

/// Certificates cost up to 60 factorizations each.
void IslandFallback::certify_after_sweeps() {
  if (!find_contradiction()) find_unbounded();
}

/// Sweeps and Newton's method in turns.
void IslandFallback::take_turns() {
  const double worth = newton_worth(attempt_.sweeps_per_newton_step());
  for (const NewtonTrial& trial : newton_trials) {
    sweep_while_cheaper(trial.expected * worth, usual_sweeps);
    if (attempt_.is_done()) return;
    attempt_.polish(trial.limits);
    if (attempt_.is_done()) return;
  }
}

/// Other starts where impulses can grow without bound, then all sweeps and Newton's method: this
/// first where it costs less.
void IslandFallback::finish_automatic() {
  const bool is_searched = searches_before_sweeps();
  if (is_searched && find_unbounded()) {
    IslandRestart(attempt_).run();
    last_.clear();
  }
  if (ends_before_sweeps()) polish_while_better();
  if (!attempt_.is_done()) sweep_while_cheaper(infinity, usual_sweeps);
  polish_while_better();
  if (!is_searched && !attempt_.is_done()) find_unbounded();
}

/// Whether all steps that Newton's method has cost less than the sweeps that are left. With a limit
/// of its steps or of time it keeps them for what the sweeps leave.
bool IslandFallback::ends_before_sweeps() {
  constexpr std::int64_t unlimited = std::numeric_limits<std::int64_t>::max();
  const ContactOptions& options = attempt_.options();
  if (options.max_newton != unlimited || std::isfinite(options.max_seconds)) return false;
  const double steps =
      2.0 * static_cast<double>(max_newton_steps(attempt_.island().contact_count()));
  const std::int64_t left = attempt_.max_sweeps() - attempt_.outcome().sweeps;
  return steps * attempt_.sweeps_per_newton_step() < static_cast<double>(left);
}

/// Newton's method as long as it halves the error: each better start may converge. Where nothing
/// has changed since it ended, it would do the same again.
void IslandFallback::polish_while_better() {
  if (attempt_.excess() == polished_) return;
  double before = infinity;
  while (!attempt_.is_done() && attempt_.excess() < before / 2) {
    before = attempt_.excess();
    attempt_.polish({});
  }
  polished_ = attempt_.excess();
}

/// Continues with sweeps until Newton's method promises to be cheaper; see method_choice.hpp.
/// Leaves the best impulses. The next sweeps continue from the last ones: near impulses of a small
/// residual that are no solution the residual first grows, and sweeps from the best ones would
/// return there.
/// @param newton_sweeps  sweeps that take as long as Newton's method would
/// @param least          sweeps between two choices, at least
void IslandFallback::sweep_while_cheaper(double newton_sweeps, std::int64_t least) {
  const IslandOutcome& outcome = attempt_.outcome();
  ContactRun<double>& run = attempt_.run();
  double* const impulse = attempt_.impulse();
  BestImpulses best(impulse, attempt_.size(), attempt_.excess());
  std::copy(last_.begin(), last_.end(), impulse);
  while (outcome.sweeps < attempt_.max_sweeps() && !attempt_.is_over() &&
         !prefers_newton(newton_sweeps, outcome.sweeps, left_)) {
    const double before = best.excess();
    const std::int64_t from = outcome.sweeps;
    const std::int64_t end = std::min(from + std::max(least, from / 2), attempt_.max_sweeps());
    const double swept = run.sweep_past_best(attempt_.index(), end, sweeps_.current());
    attempt_.measure();
    if (attempt_.is_done()) return;
    best.keep(run.best_impulse(attempt_.index()), swept);
    const std::int64_t sweeps = outcome.sweeps - from;
    if (sweeps == 0) break;  // numbers are not finite
    left_ = sweeps_left(before, best.excess(), sweeps);
    sweeps_.note(outcome.sweeps, left_);
  }
  last_.assign(impulse, impulse + attempt_.size());
  best.restore();
  attempt_.measure();
}

/// @return  whether normal offsets that sweeps show to contradict each other were noted
bool IslandFallback::clamp_contradicting(const ContradictionSearch& search) {
  for (const std::int64_t slot :
       contradicting_slots(attempt_.structure(), attempt_.run().system(), attempt_.island(), search,
                           memory_, attempt_.budget())) {
    result_.clamped.push_back(attempt_.structure().contact_of_slot[index_of(slot)]);
  }
  return !result_.clamped.empty();
}

/// Searches for a certificate that normal offsets contradict each other. Sweeps, which come first,
/// need about the square of the number of bodies in a chain to show it.
bool IslandFallback::find_contradiction() {
  if (has_other_blocks()) return false;
  const std::optional<ImpulseDirection> found = find_direction(
      attempt_.part(), attempt_.options(), DirectionCone::normals, attempt_.budget());
  if (!found) return false;
  result_.clamped_speed = found->speed;
  result_.clamped = contacts_of(*found, attempt_.structure(), attempt_.island());
  return true;
}

bool IslandFallback::find_unbounded() {
  if (has_other_blocks()) return false;
  const std::optional<ImpulseDirection> found = find_direction(
      attempt_.part(), attempt_.options(), DirectionCone::friction, attempt_.budget());
  if (!found) return false;
  result_.unbounded_speed = found->speed;
  result_.unbounded = contacts_of(*found, attempt_.structure(), attempt_.island());
  return true;
}

}  // namespace tetwarp

/// @file contact_engine.cpp
#include "host/contact_engine.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/contact_condense.hpp"
#include "host/contact_extract.hpp"
#include "host/contact_feasibility.hpp"
#include "host/contact_newton.hpp"

namespace tetwarp {

namespace {

using Clock = std::chrono::steady_clock;

std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// Offsets that ask for more than a recovery speed are lowered to it.
void clamp_offsets(ContactProblem& problem, double speed) {
  for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
    problem.velocity_offset[row] = std::max(problem.velocity_offset[row], -speed);
  }
}

bool exceeds(const ContactProblem& problem, double speed) {
  for (std::size_t row = 0; row < problem.velocity_offset.size(); row += 3) {
    if (problem.velocity_offset[row] < -speed) return true;
  }
  return false;
}

}  // namespace

ContactEngine::ContactEngine(const ContactOptions& options, int threads, ContactDevice* device)
    : options_(options), threads_(threads), device_(device) {}

ContactSystem<double> ContactEngine::prepare(const ContactProblem& problem, EngineResult& result) {
  if (!pattern_ || !has_pattern(problem, *pattern_)) {
    structure_ = make_structure(problem, options_.skip);
    pattern_ = pattern_of(problem);
    kept_ = {};
  }
  forget_unless_same(problem);
  ContactSystem<double> system;
  fill_system(problem, options_, structure_, system, result.savings);
  return system;
}

EngineResult ContactEngine::solve(const ContactProblem& given) {
  const auto start = Clock::now();
  std::optional<ContactProblem> changed;
  if (exceeds(given, options_.recovery_speed)) {
    changed = given;
    clamp_offsets(*changed, options_.recovery_speed);
  }
  std::vector<std::int32_t> clamped;
  // Each round frees at least one more contact; in practice one or two are enough.
  for (;;) {
    const ContactProblem& problem = changed ? *changed : given;
    EngineResult result;
    const ContactSystem<double> system = prepare(problem, result);
    is_on_device_ = false;
    result.setup_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    result.impulse.assign(3 * problem.friction.size(), 0.0);
    result.body_velocity.assign(index_of(problem.dof_count()), 0.0);
    result.outcomes.resize(index_of(structure_.contact_islands));
    solve_uncoupled(problem, system, result);
    solve_coupled(problem, system, result);
    solve_contactless(problem, system, result);
    if (result.clamped.empty()) {
      result.clamped = std::move(clamped);
      return result;
    }
    if (!changed) changed = given;
    bool is_new = false;
    for (const std::int32_t c : result.clamped) {
      double& offset = (structure_.is_local ? changed->free_velocity
                                            : changed->velocity_offset)[3 * index_of(c)];
      is_new = is_new || offset < 0;
      offset = std::max(offset, 0.0);
    }
    if (!is_new) {
      result.clamped.insert(result.clamped.end(), clamped.begin(), clamped.end());
      return result;
    }
    clamped.insert(clamped.end(), result.clamped.begin(), result.clamped.end());
    changed->impulse_guess.clear();
  }
}

void ContactEngine::solve_uncoupled(const ContactProblem& problem,
                                    const ContactSystem<double>& system,
                                    EngineResult& result) {
  std::vector<double> start = gathered(problem.impulse_guess, 3, structure_.contact_of_slot.data(),
                                       problem.contact_count());
  ContactRun<double> run(options_, threads_, structure_, system, result.outcomes);
  if (device_ != nullptr) {
    take_to_device(system);
    if (start.empty()) start.assign(system.free_velocity.size(), 0.0);
    result.updates_skipped =
        device_->solve_uncoupled(options_, run.rules(), start, result.outcomes);
  } else if (options_.precision == ContactPrecision::float32) {
    const ContactSystem<float> rounded = make_float32(system);
    ContactRun<float> coarse(options_, threads_, structure_, rounded, result.outcomes);
    coarse.start_from({start.begin(), start.end()});
    coarse.solve();
    start.assign(coarse.state().impulse.begin(), coarse.state().impulse.end());
    result.updates_skipped = coarse.updates_skipped();
  }
  run.start_from(start);
  if (device_ == nullptr && options_.precision == ContactPrecision::float64) {
    run.solve();
    result.updates_skipped = run.updates_skipped();
  }
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    result.colors = std::max(result.colors, island.color_end - island.color_begin - 1);
    if (island.is_coupled) continue;
    IslandOutcome& outcome = result.outcomes[index_of(i)];
    outcome.sums = run.measure(i);
    outcome.reason = run.is_done(i, outcome.sums) ? StopReason::converged : outcome.reason;
    if (!run.is_done(i, outcome.sums)) fall_back(problem, i, run, result);
    name_largest(structure_, 0, outcome.sums);
    scatter_impulses(structure_, island, run.state().impulse.data() + 3 * island.slot_begin,
                     result.impulse);
    if (structure_.is_local) continue;
    scatter_velocities(structure_, island, run.state().body_velocity.data() + island.dof_begin,
                       result.body_velocity);
  }
}

void ContactEngine::take_to_device(const ContactSystem<double>& system) {
  if (!is_on_device_) device_->set_problem(options_, structure_, system);
  is_on_device_ = true;
}

void ContactEngine::fall_back(const ContactProblem& problem,
                              std::int64_t island,
                              ContactRun<double>& run,
                              EngineResult& result) {
  IslandOutcome& outcome = result.outcomes[index_of(island)];
  for (const std::int64_t slot : contradicting_slots(
           structure_, run.system(), structure_.islands[index_of(island)], options_.max_sweeps)) {
    result.clamped.push_back(structure_.contact_of_slot[index_of(slot)]);
  }
  if (!result.clamped.empty()) return;
  if (options_.method == ContactMethod::automatic || options_.method == ContactMethod::newton) {
    polish(problem, island, run, outcome);
  }
  outcome.sums = run.measure(island);
  if (options_.method != ContactMethod::automatic || run.is_done(island, outcome.sums)) return;
  run.insist(island);
  outcome.sums = run.measure(island);
  if (run.is_done(island, outcome.sums)) return;
  polish(problem, island, run, outcome);  // from closer by it may find the way
  outcome.sums = run.measure(island);
}

/// Newton from where the sweeps ended; what it finds is kept where it is better.
void ContactEngine::polish(const ContactProblem& problem,
                           std::int64_t i,
                           ContactRun<double>& run,
                           IslandOutcome& outcome) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  ContactOptions options = options_;
  options.tolerance /= 2;  // of the island, whose share in the error of the whole is smaller
  double* const impulse = run.state().impulse.data() + 3 * island.slot_begin;
  std::vector<double> polished(impulse, impulse + 3 * island.contact_count()), body_velocity;
  const std::vector<double> swept = polished;
  const NewtonResult newton = newton_polish(make_island_problem(problem, structure_, island),
                                            options, polished, body_velocity);
  outcome.newton_iterations += newton.iterations;
  outcome.methods.push_back("newton");
  const double before = run.excess(i, outcome.sums);
  std::copy(polished.begin(), polished.end(), impulse);
  if (run.excess(i, run.measure(i)) > before) std::copy(swept.begin(), swept.end(), impulse);
}

void ContactEngine::solve_contactless(const ContactProblem& problem,
                                      const ContactSystem<double>& system,
                                      EngineResult& result) {
  for (std::size_t i = index_of(structure_.contact_islands); i < structure_.islands.size(); ++i) {
    const ContactIsland& island = structure_.islands[i];
    result.bodies_skipped += island.block_end - island.block_begin;
    if (!island.is_coupled) {
      scatter_velocities(structure_, island, system.body_free.data() + island.dof_begin,
                         result.body_velocity);
      continue;
    }
    const CondensedProblem condensed(make_island_problem(problem, structure_, island));
    scatter_velocities(structure_, island, condensed.body_velocity({}).data(),
                       result.body_velocity);
  }
}

}  // namespace tetwarp

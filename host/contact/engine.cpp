/// @file engine.cpp
#include "host/contact/engine.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/contact/condense.hpp"
#include "host/contact/feasibility.hpp"
#include "host/contact/newton/newton.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {

namespace {

using Clock = std::chrono::steady_clock;

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

void ContactEngine::prepare(const ContactProblem& problem, EngineResult& result) {
  if (!pattern_ || !has_pattern(problem, *pattern_)) {
    structure_ = device_ != nullptr ? make_structure(problem, options_.skip, *device_)
                                    : make_structure(problem, options_.skip);
    pattern_ = pattern_of(problem);
    kept_ = {};
  }
  forget_unless_same(problem);
  has_host_system_ = has_device_system_ = false;
  if (device_ != nullptr) {
    take_to_device(problem, result);
  } else {
    fill_system(problem, options_, structure_, system_, result.savings, threads_);
    has_host_system_ = true;
  }
}

/// The system on the host; of a device's solve only what it leaves to the host needs it.
ContactSystem<double>& ContactEngine::host_system(const ContactProblem& problem) {
  ContactSavings counted;
  if (!has_host_system_) {
    fill_system(problem, options_, structure_, system_, counted, threads_);
    has_host_system_ = true;
  }
  return system_;
}

void ContactEngine::take_to_device(const ContactProblem& problem, EngineResult& result) {
  if (!has_device_system_) {
    result.savings = device_->set_problem(options_, structure_, input_of(problem));
  }
  has_device_system_ = true;
}

std::vector<double> ContactEngine::guess_of(const ContactProblem& problem) const {
  return gathered(problem.impulse_guess, 3, structure_.contact_of_slot.data(),
                  problem.contact_count());
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
    prepare(problem, result);
    result.setup_seconds = std::chrono::duration<double>(Clock::now() - start).count();
    result.impulse.assign(3 * problem.friction.size(), 0.0);
    result.body_velocity.assign(index_of(problem.dof_count()), 0.0);
    result.outcomes.resize(index_of(structure_.contact_islands));
    solve_uncoupled(problem, result);
    solve_coupled(problem, result);
    solve_contactless(problem, result);
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

void ContactEngine::solve_uncoupled(const ContactProblem& problem, EngineResult& result) {
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    if (island.is_coupled) continue;
    result.colors = std::max(result.colors, island.color_end - island.color_begin - 1);
  }
  device_ != nullptr ? solve_on_device(problem, result) : solve_on_host(problem, result);
}

void ContactEngine::solve_on_host(const ContactProblem& problem, EngineResult& result) {
  ContactSystem<double>& system = host_system(problem);
  free_motion_ = system.body_free;
  std::vector<double> start = guess_of(problem);
  ContactRun<double> run(options_, threads_, structure_, system, result.outcomes);
  if (options_.precision == ContactPrecision::float32) {
    const ContactSystem<float> rounded = make_float32(structure_, system);
    ContactRun<float> coarse(options_, threads_, structure_, rounded, result.outcomes);
    coarse.start_from({start.begin(), start.end()});
    coarse.solve();
    start.assign(coarse.state().impulse.begin(), coarse.state().impulse.end());
    result.updates_skipped = coarse.updates_skipped();
    run.start_from(start);
  } else {
    run.start_from(start);
    run.solve();
    result.updates_skipped = run.updates_skipped();
  }
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    if (!structure_.islands[index_of(i)].is_coupled) take_from_run(problem, i, run, result);
  }
}

/// What the device does not solve goes on from its impulses on the host.
void ContactEngine::solve_on_device(const ContactProblem& problem, EngineResult& result) {
  std::vector<double> impulse = guess_of(problem);
  impulse.resize(3 * structure_.contact_of_slot.size(), 0.0);
  free_motion_.resize(structure_.dof_of_place.size());
  result.updates_skipped =
      device_->solve_uncoupled(options_, impulse, free_motion_, result.outcomes);
  std::optional<ContactRun<double>> run;
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    if (island.is_coupled) continue;
    IslandOutcome& outcome = result.outcomes[index_of(i)];
    if (outcome.reason != StopReason::converged) {
      if (!run) {
        run.emplace(options_, threads_, structure_, host_system(problem), result.outcomes);
        run->start_from(impulse);
      }
      take_from_run(problem, i, *run, result);
      continue;
    }
    to_problem_index(structure_, 0, outcome.sums);
    scatter_impulses(structure_, island, impulse.data() + 3 * island.slot_begin, result.impulse);
    if (structure_.is_local) continue;
    scatter_velocities(structure_, island, free_motion_.data() + island.dof_begin,
                       result.body_velocity);
  }
}

/// Judges an island in float64 and takes it, or falls back.
void ContactEngine::take_from_run(const ContactProblem& problem,
                                  std::int64_t i,
                                  ContactRun<double>& run,
                                  EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  outcome.sums = run.measure(i);
  outcome.reason = run.is_done(i, outcome.sums) ? StopReason::converged : outcome.reason;
  if (!run.is_done(i, outcome.sums)) fall_back(problem, i, run, result);
  to_problem_index(structure_, 0, outcome.sums);
  scatter_impulses(structure_, island, run.state().impulse.data() + 3 * island.slot_begin,
                   result.impulse);
  if (structure_.is_local) return;
  scatter_velocities(structure_, island, run.state().body_velocity.data() + island.dof_begin,
                     result.body_velocity);
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
  run.run_to_budget(island);
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

void ContactEngine::solve_contactless(const ContactProblem& problem, EngineResult& result) {
  for (std::size_t i = index_of(structure_.contact_islands); i < structure_.islands.size(); ++i) {
    const ContactIsland& island = structure_.islands[i];
    result.bodies_skipped += island.block_end - island.block_begin;
    if (!island.is_coupled) {
      scatter_velocities(structure_, island, free_motion_.data() + island.dof_begin,
                         result.body_velocity);
      continue;
    }
    const CondensedProblem condensed(make_island_problem(problem, structure_, island));
    scatter_velocities(structure_, island, condensed.body_velocity({}).data(),
                       result.body_velocity);
  }
}

}  // namespace tetwarp

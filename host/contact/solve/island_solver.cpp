/// @file island_solver.cpp
/// Solves islands on the host or the device and copies their results.
#include "host/contact/solve/island_solver.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/solve/island_fallback.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {

IslandSolver::IslandSolver(const ContactOptions& options, int threads, ContactDevice* device)
    : options_(options), threads_(threads), device_(device) {}

ContactSavings IslandSolver::set_problem(const ContactProblem& problem, DeviceRun* found) {
  problem_ = &problem;
  found_ = found;
  has_host_system_ = has_device_system_ = false;
  contradiction_memory_.bare.reset();
  if (found != nullptr) {
    has_device_system_ = true;
    return found->end.savings;
  }
  if (device_ != nullptr) return set_device_problem();
  ContactSavings savings;
  fill_system(problem, options_, structure_, system_, savings, threads_);
  has_host_system_ = true;
  return savings;
}

/// The numbers on the host. With a device they are set only if the host solves a part.
ContactSystem<double>& IslandSolver::host_system() {
  ContactSavings counted;
  if (!has_host_system_) {
    fill_system(*problem_, options_, structure_, system_, counted, threads_);
    has_host_system_ = true;
  }
  return system_;
}

ContactSavings IslandSolver::set_device_problem() {
  has_device_system_ = true;
  return device_->set_problem(options_, structure_, input_of(*problem_));
}

std::vector<double> IslandSolver::guess() const {
  return gathered(problem_->impulse_guess, 3, structure_.contact_of_slot.data(),
                  problem_->contact_count());
}

void IslandSolver::solve_uncoupled(EngineResult& result) {
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    if (island.is_coupled) continue;
    result.colors = std::max(result.colors, island.color_end - island.color_begin - 1);
  }
  if (device_ != nullptr) device_->budget = budget_;
  device_ != nullptr ? solve_on_device(result) : solve_on_host(result);
}

void IslandSolver::solve_on_host(EngineResult& result) {
  ContactSystem<double>& system = host_system();
  free_motion_ = system.body_free;
  std::vector<double> start = guess();
  ContactRun<double> run(options_, threads_, structure_, system, result.outcomes, budget_);
  const auto all_sweeps = [this](std::int64_t) { return options_.max_sweeps; };
  if (options_.precision == ContactPrecision::float32) {
    const ContactSystem<float> rounded = make_float32(structure_, system);
    ContactRun<float> coarse(options_, threads_, structure_, rounded, result.outcomes, budget_);
    coarse.start_from({start.begin(), start.end()});
    coarse.solve(all_sweeps);
    start.assign(coarse.state().impulse.begin(), coarse.state().impulse.end());
    result.updates_skipped = coarse.updates_skipped();
    run.start_from(start);
  } else {
    run.start_from(start);
    run.solve([this](std::int64_t i) { return IslandFallback::first_sweeps(host_problem(), i); });
    result.updates_skipped = run.updates_skipped();
  }
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    if (!structure_.islands[index_of(i)].is_coupled) finish(i, run, result);
  }
}

/// Islands that do not converge on the device continue on the host from its impulses.
void IslandSolver::solve_on_device(EngineResult& result) {
  std::vector<double> impulse;
  if (found_ != nullptr) {
    DeviceRun& found = *std::exchange(found_, nullptr);
    impulse = std::move(found.end.impulse);
    free_motion_ = std::move(found.end.body_velocity);
    result.outcomes = std::move(found.outcomes);
    result.updates_skipped = found.end.updates_skipped;
  } else {
    impulse = guess();
    impulse.resize(3 * structure_.contact_of_slot.size(), 0.0);
    free_motion_.resize(structure_.dof_of_place.size());
    result.updates_skipped =
        device_->solve_uncoupled(options_, impulse, free_motion_, result.outcomes);
  }
  std::optional<ContactRun<double>> run;
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    if (island.is_coupled) continue;
    IslandOutcome& outcome = result.outcomes[index_of(i)];
    if (outcome.reason != StopReason::converged) {
      if (!run) {
        run.emplace(options_, threads_, structure_, host_system(), result.outcomes, budget_);
        run->start_from(impulse);
      }
      finish(i, *run, result);
      continue;
    }
    to_problem_index(structure_, 0, outcome.sums);
    scatter_impulses(structure_, island, impulse.data() + 3 * island.slot_begin, result.impulse);
    if (structure_.is_local) continue;
    scatter_velocities(structure_, island, free_motion_.data() + island.dof_begin,
                       result.body_velocity);
  }
}

/// Measures an island in float64, falls back to other methods if it has not converged, and copies
/// its impulses and velocities to the result.
void IslandSolver::finish(std::int64_t i, ContactRun<double>& run, EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  outcome.sums = run.measure(i);
  outcome.reason = run.is_done(i, outcome.sums) ? StopReason::converged : outcome.reason;
  if (!run.is_done(i, outcome.sums)) {
    IslandAttempt attempt(host_problem(), i, run, outcome);
    IslandFallback(attempt, contradiction_memory_, result).run();
  }
  to_problem_index(structure_, 0, outcome.sums);
  scatter_impulses(structure_, island, run.state().impulse.data() + 3 * island.slot_begin,
                   result.impulse);
  if (structure_.is_local) return;
  scatter_velocities(structure_, island, run.state().body_velocity.data() + island.dof_begin,
                     result.body_velocity);
}

void IslandSolver::iterate(std::int64_t i, std::int64_t max_iterations, EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  const std::vector<double> guess = this->guess();
  std::vector<double> impulse(3 * structure_.contact_of_slot.size());
  std::vector<double> body_velocity(structure_.dof_of_place.size());
  if (device_ != nullptr) {
    device_->budget = budget_;
    if (!has_device_system_) result.savings = set_device_problem();
    device_->solve_coupled(options_, island, guess, max_iterations, impulse, body_velocity,
                           outcome);
  } else {
    CpuExec exec(threads_, StageClocks::off);
    if (block_jacobi_memory_ == nullptr)
      block_jacobi_memory_ = std::make_shared<BlockJacobiMemory<CpuExec>>();
    ContactSystem<double>& system = host_system();
    const ContactIndices indices = structure_.indices();
    const ContactNumbers<double> numbers = system.numbers(indices);
    const CoupledTask task{options_,       island, indices.color_start, numbers, view_of(guess),
                           max_iterations, budget_};
    const CoupledSolution best = solve_coupled_island(exec, task, *block_jacobi_memory_, outcome);
    exec.get(best.impulse, impulse.data());
    exec.get(best.body_velocity, body_velocity.data());
  }
  to_problem_index(structure_, 0, outcome.sums);
  result.colors = std::max(result.colors, island.color_end - island.color_begin - 1);
  scatter_impulses(structure_, island, impulse.data() + 3 * island.slot_begin, result.impulse);
  scatter_velocities(structure_, island, body_velocity.data() + island.dof_begin,
                     result.body_velocity);
}

}  // namespace tetwarp

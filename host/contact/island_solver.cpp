#include "host/contact/island_solver.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/certificate.hpp"
#include "host/contact/feasibility.hpp"
#include "host/contact/newton/newton.hpp"
#include "host/contact/problem/row_blocks.hpp"
#include "host/contact/structure/extract.hpp"
#include "host/contact/sweeps/method_names.hpp"

namespace tetwarp {
namespace {
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

IslandSolver::IslandSolver(const ContactOptions& options, int threads, ContactDevice* device)
    : options_(options), threads_(threads), device_(device) {}

ContactSavings IslandSolver::set_problem(const ContactProblem& problem) {
  problem_ = &problem;
  has_host_system_ = has_device_system_ = false;
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
  if (options_.precision == ContactPrecision::float32) {
    const ContactSystem<float> rounded = make_float32(structure_, system);
    ContactRun<float> coarse(options_, threads_, structure_, rounded, result.outcomes, budget_);
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
    if (!structure_.islands[index_of(i)].is_coupled) finish(i, run, result);
  }
}

/// Islands that do not converge on the device continue on the host from its impulses.
void IslandSolver::solve_on_device(EngineResult& result) {
  std::vector<double> impulse = guess();
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
  if (!run.is_done(i, outcome.sums)) fall_back(i, run, result);
  to_problem_index(structure_, 0, outcome.sums);
  scatter_impulses(structure_, island, run.state().impulse.data() + 3 * island.slot_begin,
                   result.impulse);
  if (structure_.is_local) return;
  scatter_velocities(structure_, island, run.state().body_velocity.data() + island.dof_begin,
                     result.body_velocity);
}

void IslandSolver::fall_back(std::int64_t island, ContactRun<double>& run, EngineResult& result) {
  IslandOutcome& outcome = result.outcomes[index_of(island)];
  if (budget_ != nullptr && budget_->is_over()) return;
  for (const std::int64_t slot :
       contradicting_slots(structure_, run.system(), structure_.islands[index_of(island)],
                           options_.max_sweeps, budget_)) {
    result.clamped.push_back(structure_.contact_of_slot[index_of(slot)]);
  }
  if (!result.clamped.empty()) return;
  if (has_other_blocks(*problem_, structure_, structure_.islands[index_of(island)])) {
    continue_with_rows(island, run, result);
    return;
  }
  if (options_.method == ContactMethod::automatic || options_.method == ContactMethod::newton) {
    polish(island, run, outcome);
  }
  outcome.sums = run.measure(island);
  if (run.is_done(island, outcome.sums) || !searches_certificates(options_)) return;
  if (find_contradiction(island, result)) return;
  if (options_.method == ContactMethod::automatic) {
    run.run_to_budget(island);
    outcome.sums = run.measure(island);
    if (run.is_done(island, outcome.sums)) return;
    polish(island, run, outcome);  // this better start may converge
    outcome.sums = run.measure(island);
  }
  if (!run.is_done(island, outcome.sums)) find_unbounded(island, result);
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
  for (const bool is_first : {true, false}) {
    if (has_newton) polish(island, run, outcome);
    outcome.sums = run.measure(island);
    if (!is_first || !is_automatic || run.is_done(island, outcome.sums)) return;
    run.run_to_budget(island);
    outcome.sums = run.measure(island);
    if (run.is_done(island, outcome.sums)) return;
  }
}

/// Searches for a certificate that normal offsets contradict each other. Sweeps, which come first,
/// need about the square of the number of bodies in a chain to show it.
bool IslandSolver::find_contradiction(std::int64_t i, EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  const std::optional<ImpulseDirection> found =
      find_direction(make_island_problem(*problem_, structure_, island), options_,
                     DirectionCone::normals, budget_);
  if (!found) return false;
  result.clamped_speed = found->speed;
  result.clamped = contacts_of(*found, structure_, island);
  return true;
}

void IslandSolver::find_unbounded(std::int64_t i, EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  const std::optional<ImpulseDirection> found =
      find_direction(make_island_problem(*problem_, structure_, island), options_,
                     DirectionCone::friction, budget_);
  if (!found) return;
  result.unbounded_speed = found->speed;
  result.unbounded = contacts_of(*found, structure_, island);
}

/// Newton's method from the impulses of the sweeps; keeps its impulses unless their error is
/// larger.
void IslandSolver::polish(std::int64_t i, ContactRun<double>& run, IslandOutcome& outcome) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  ContactOptions options = options_;
  options.tolerance /= 2;  // relative to this island, not to the whole problem
  double* const impulse = run.state().impulse.data() + 3 * island.slot_begin;
  std::vector<double> polished(impulse, impulse + 3 * island.contact_count()), body_velocity;
  const std::vector<double> swept = polished;
  const NewtonResult newton = newton_polish(make_island_problem(*problem_, structure_, island),
                                            options, polished, body_velocity, budget_);
  outcome.newton_iterations += newton.iterations;
  if (newton.iterations > 0) outcome.methods.push_back(report_name_of(ContactMethod::newton));
  const double before = run.excess(i, outcome.sums);
  std::copy(polished.begin(), polished.end(), impulse);
  if (run.excess(i, run.measure(i)) > before) std::copy(swept.begin(), swept.end(), impulse);
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
    CpuContactExec exec(threads_);
    if (block_jacobi_memory_ == nullptr)
      block_jacobi_memory_ = std::make_shared<BlockJacobiMemory<CpuContactExec>>();
    ContactSystem<double>& system = host_system();
    const ContactIndices indices = structure_.indices();
    const ContactNumbers<double> numbers = system.numbers(indices);
    ContactSystem<float> rounded;
    if (options_.precision == ContactPrecision::float32) rounded = make_float32(structure_, system);
    const CoupledTask task{options_,
                           island,
                           indices.color_start,
                           numbers,
                           rounded.numbers(indices),
                           view_of(guess),
                           max_iterations,
                           budget_};
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

/// @file engine_coupled.cpp
/// Islands of bodies that A couples: iterated, condensed, or both in turn.
#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/condense.hpp"
#include "host/contact/engine.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {

namespace {

/// How the contacts of coupled bodies are solved: by so many outer iterations, and condensed where
/// these are none or fail.
struct CoupledRoute {
  std::int64_t outer_iterations;
  bool condenses;
};

CoupledRoute coupled_route(const ContactOptions& options, const ContactIsland& island) {
  constexpr std::int64_t cheap = 300'000;      // numbers of A^-1 J^T that cost about a millisecond
  constexpr std::int64_t max_contacts = 2000;  // 290 MB for the Delassus matrix
  constexpr std::int64_t patience = 1000;
  const int sweeps = sweeps_per_step(options, island);
  const std::int64_t budget = (options.max_sweeps + sweeps - 1) / sweeps;
  if (options.method == ContactMethod::mass_splitting || options.method == ContactMethod::newton ||
      options.coupling == ContactCoupling::condensed) {
    return {0, true};
  }
  if (options.coupling == ContactCoupling::iterated) return {budget, false};
  if (options.method != ContactMethod::automatic) return {0, true};
  const std::int64_t rows = 3 * island.contact_count();
  if (rows * (island.dof_end - island.dof_begin) < cheap) return {0, true};
  const bool fits = island.contact_count() <= max_contacts;
  return {fits ? std::min(budget, patience) : budget, fits};
}

/// Outer iterations that cost as much as condensing an island, for a row of J: 6 to 12 on slabs of
/// 10,000 tetrahedra with 531 and 151 contacts.
constexpr std::int64_t condensing_costs = 7;

}  // namespace

/// The contacts of an island alone.
struct Condensation {
  Condensation(const ContactProblem& part, ContactEngine solver)
      : problem(part), engine(std::move(solver)) {}

  CondensedProblem problem;
  ContactEngine engine;
};

void ContactEngine::forget_unless_same(const ContactProblem& problem) {
  const auto is_coupled = [](const ContactIsland& island) { return island.is_coupled; };
  if (!options_.skip.constant_systems ||
      std::none_of(structure_.islands.begin(), structure_.islands.end(), is_coupled)) {
    return;
  }
  const auto is_same = [](const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
  };
  if (is_same(kept_.system, problem.system.value) &&
      is_same(kept_.jacobian, problem.jacobian.value)) {
    return;
  }
  kept_.system = problem.system.value;
  kept_.jacobian = problem.jacobian.value;
  kept_.islands.assign(structure_.islands.size(), {});
}

void ContactEngine::solve_coupled(const ContactProblem& problem, EngineResult& result) {
  for (std::int64_t i = 0; i < structure_.contact_islands; ++i) {
    const ContactIsland& island = structure_.islands[index_of(i)];
    if (!island.is_coupled) continue;
    CoupledRoute route = coupled_route(options_, island);
    const std::int64_t rows = 3 * island.contact_count();
    const bool sweeps_fast = rows * rows <= static_cast<std::int64_t>(problem.system.value.size());
    if (!kept_.islands.empty() && route.condenses && sweeps_fast &&
        kept_.islands[index_of(i)].outer_iterations >= condensing_costs * rows) {
      route.outer_iterations = 0;  // where A and J stay, condensing once pays at last
    }
    if (route.outer_iterations > 0) iterate(problem, i, route.outer_iterations, result);
    const bool is_solved =
        route.outer_iterations > 0 && result.outcomes[index_of(i)].reason == StopReason::converged;
    if (!is_solved && route.condenses) condense(problem, i, result);
    if (!kept_.islands.empty()) {
      kept_.islands[index_of(i)].outer_iterations += result.outcomes[index_of(i)].outer_iterations;
    }
  }
}

void ContactEngine::iterate(const ContactProblem& problem,
                            std::int64_t i,
                            std::int64_t max_iterations,
                            EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  const std::vector<double> guess = guess_of(problem);
  std::vector<double> impulse(3 * structure_.contact_of_slot.size());
  std::vector<double> body_velocity(structure_.dof_of_place.size());
  if (device_ != nullptr) {
    take_to_device(problem, result);
    device_->solve_coupled(options_, island, guess, max_iterations, impulse, body_velocity,
                           outcome);
  } else {
    CpuContactExec exec(threads_);
    if (block_jacobi_memory_ == nullptr)
      block_jacobi_memory_ = std::make_shared<BlockJacobiMemory<CpuContactExec>>();
    ContactSystem<double>& system = host_system(problem);
    const ContactIndices indices = structure_.indices();
    const ContactNumbers<double> numbers = system.numbers(indices);
    ContactSystem<float> rounded;
    if (options_.precision == ContactPrecision::float32) rounded = make_float32(structure_, system);
    const CoupledTask task{
        options_,       island,        indices.color_start, numbers, rounded.numbers(indices),
        view_of(guess), max_iterations};
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

void ContactEngine::condense(const ContactProblem& problem, std::int64_t i, EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  const ContactProblem part = make_island_problem(problem, structure_, island);
  std::shared_ptr<Condensation> unkept;
  std::shared_ptr<Condensation>& kept =
      kept_.islands.empty() ? unkept : kept_.islands[index_of(i)].condensation;
  if (kept == nullptr) {
    kept = std::make_shared<Condensation>(part, ContactEngine(options_, threads_, device_));
  } else {
    kept->problem.update(part);
    ++result.condensations_kept;
  }
  has_device_system_ = false;  // the contacts alone take its place there
  const EngineResult inner = kept->engine.solve(kept->problem.local());
  const std::vector<double> v = kept->problem.body_velocity(inner.impulse);
  scatter_impulses(structure_, island, inner.impulse.data(), result.impulse);
  scatter_velocities(structure_, island, v.data(), result.body_velocity);
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  const IslandOutcome before = std::exchange(outcome, inner.outcomes[0]);
  to_problem_index(structure_, island.slot_begin, outcome.sums);
  outcome.sweeps += before.sweeps;
  outcome.outer_iterations = before.outer_iterations;
  outcome.contact_updates += before.contact_updates;
  outcome.methods.insert(outcome.methods.begin(), before.methods.begin(), before.methods.end());
  result.updates_skipped += inner.updates_skipped;
  result.colors = std::max(result.colors, inner.colors);
  for (const std::int32_t c : inner.clamped) {
    result.clamped.push_back(structure_.contact_of_slot[index_of(island.slot_begin + c)]);
  }
}

}  // namespace tetwarp

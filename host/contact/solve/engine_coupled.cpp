/// @file engine_coupled.cpp
/// Islands of bodies that A couples: iterated, condensed, or first iterated and then condensed.
#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/solve/condense.hpp"
#include "host/contact/solve/engine.hpp"
#include "host/contact/solve/feasibility.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {
namespace {
/// How a coupled island is solved: by at most `outer_iterations` outer iterations, and by
/// condensing if these are 0 or do not converge.
struct CoupledRoute {
  std::int64_t outer_iterations;
  bool condenses;
};

/// Outer iterations that make options.max_sweeps sweeps.
std::int64_t iteration_budget(const ContactOptions& options, const ContactIsland& island) {
  const int sweeps = sweeps_per_step(options, island);
  return (options.max_sweeps + sweeps - 1) / sweeps;
}

/// Memory of a condensed island [bytes]: its Delassus matrix is held three times.
double condensed_bytes(const ContactIsland& island) {
  const auto contacts = static_cast<double>(island.contact_count());
  return 3 * 72 * contacts * contacts;
}

CoupledRoute coupled_route(const ContactOptions& options, const ContactIsland& island) {
  constexpr std::int64_t cheap = 300'000;      // entries of A^-1 J^T that take about a millisecond
  constexpr std::int64_t max_contacts = 2000;  // 290 MB for the Delassus matrix
  constexpr std::int64_t max_iterations = 1000;
  const std::int64_t budget = iteration_budget(options, island);
  if (options.method == ContactMethod::mass_splitting || options.method == ContactMethod::newton ||
      options.coupling == ContactCoupling::condensed) {
    return {0, true};
  }
  if (options.coupling == ContactCoupling::iterated) return {budget, false};
  if (options.method != ContactMethod::automatic) return {0, true};
  const std::int64_t rows = 3 * island.contact_count();
  if (rows * (island.dof_end - island.dof_begin) < cheap) return {0, true};
  const bool fits = island.contact_count() <= max_contacts;
  return {fits ? std::min(budget, max_iterations) : budget, fits};
}

/// Outer iterations per row of J that take as long as condensing the island. Measured: 6 to 12, on
/// slabs of 10,000 tetrahedra with 531 and 151 contacts.
constexpr std::int64_t condensing_iterations = 7;
}  // namespace

/// The contacts of a coupled island with their dense Delassus matrix, and the solver for them.
struct Condensation {
  Condensation(const ContactProblem& part, IslandSolver island_solver, SolveBudget* budget)
      : problem(part, budget), solver(std::move(island_solver)) {
    solver.set_structure(make_dense_structure(problem.local().contact_count()));
  }

  EngineResult solve(SolveBudget* budget) {
    solver.set_budget(budget);
    return solve_feasible(problem.local(), {}, [this](const ContactProblem& local) {
      EngineResult result = make_result(local, solver.structure());
      result.savings = solver.set_problem(local);
      solver.solve_uncoupled(result);
      return result;
    });
  }

  CondensedProblem problem;
  IslandSolver solver;
};

void ContactEngine::reset_cache_if_changed(const ContactProblem& problem) {
  const std::vector<ContactIsland>& islands = islands_.structure().islands;
  const auto is_coupled = [](const ContactIsland& island) { return island.is_coupled; };
  if (!options_.skip.constant_systems || std::none_of(islands.begin(), islands.end(), is_coupled)) {
    return;
  }
  const auto is_same = [](const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
  };
  if (is_same(cache_.system, problem.system.value) &&
      is_same(cache_.jacobian, problem.jacobian.value)) {
    return;
  }
  cache_.system = problem.system.value;
  cache_.jacobian = problem.jacobian.value;
  cache_.islands.assign(islands.size(), {});
}

void ContactEngine::solve_coupled(const ContactProblem& problem, EngineResult& result) {
  const ContactStructure& structure = islands_.structure();
  for (std::int64_t i = 0; i < structure.contact_islands; ++i) {
    const ContactIsland& island = structure.islands[index_of(i)];
    if (!island.is_coupled) continue;
    CoupledRoute route = coupled_route(options_, island);
    const std::int64_t rows = 3 * island.contact_count();
    const bool is_kept =
        !cache_.islands.empty() && cache_.islands[index_of(i)].condensation != nullptr;
    if (route.condenses && !is_kept && !budget_->allows_memory(condensed_bytes(island))) {
      route = {iteration_budget(options_, island), false};
    }
    const bool sweeps_fast = rows * rows <= static_cast<std::int64_t>(problem.system.value.size());
    if (!cache_.islands.empty() && route.condenses && sweeps_fast &&
        cache_.islands[index_of(i)].outer_iterations >= condensing_iterations * rows) {
      route.outer_iterations = 0;  // A and J do not change: condensing once is cheaper from now on
    }
    if (route.outer_iterations > 0) islands_.iterate(i, route.outer_iterations, result);
    const bool is_solved =
        route.outer_iterations > 0 && result.outcomes[index_of(i)].reason == StopReason::converged;
    const bool is_over = route.outer_iterations > 0 && budget_->is_over();
    if (!is_solved && route.condenses && !is_over) condense(problem, i, result);
    if (!cache_.islands.empty()) {
      cache_.islands[index_of(i)].outer_iterations += result.outcomes[index_of(i)].outer_iterations;
    }
  }
}

void ContactEngine::condense(const ContactProblem& problem, std::int64_t i, EngineResult& result) {
  const ContactStructure& structure = islands_.structure();
  const ContactIsland& island = structure.islands[index_of(i)];
  const ContactProblem part = make_island_problem(problem, structure, island);
  std::shared_ptr<Condensation> temporary;
  std::shared_ptr<Condensation>& kept =
      cache_.islands.empty() ? temporary : cache_.islands[index_of(i)].condensation;
  if (kept == nullptr) {
    try {
      kept =
          std::make_shared<Condensation>(part, IslandSolver(options_, threads_, device_), budget_);
    } catch (const BudgetOver&) {
      // The best so far is the result of the iteration; without one, that of its first step.
      if (result.outcomes[index_of(i)].outer_iterations == 0) islands_.iterate(i, 1, result);
      return;
    }
  } else {
    kept->problem.update(part);
    ++result.condensations_kept;
  }
  islands_.forget_device();
  const EngineResult inner = kept->solve(budget_);
  const std::vector<double> v = kept->problem.body_velocity(inner.impulse);
  scatter_impulses(structure, island, inner.impulse.data(), result.impulse);
  scatter_velocities(structure, island, v.data(), result.body_velocity);
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  const IslandOutcome before = std::exchange(outcome, inner.outcomes[0]);
  to_problem_index(structure, island.slot_begin, outcome.sums);
  outcome.sweeps += before.sweeps;
  outcome.outer_iterations = before.outer_iterations;
  outcome.contact_updates += before.contact_updates;
  outcome.methods.insert(outcome.methods.begin(), before.methods.begin(), before.methods.end());
  result.updates_skipped += inner.updates_skipped;
  result.colors = std::max(result.colors, inner.colors);
  const auto append = [&](const std::vector<std::int32_t>& from, std::vector<std::int32_t>& to) {
    for (const std::int32_t c : from) {
      to.push_back(structure.contact_of_slot[index_of(island.slot_begin + c)]);
    }
  };
  append(inner.clamped, result.clamped);
  append(inner.unbounded, result.unbounded);
  result.clamped_speed = std::max(result.clamped_speed, inner.clamped_speed);
  result.unbounded_speed = std::max(result.unbounded_speed, inner.unbounded_speed);
}

}  // namespace tetwarp

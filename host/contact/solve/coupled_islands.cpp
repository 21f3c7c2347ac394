/// @file coupled_islands.cpp
/// The choice between iterating and condensing, and the condensed islands.
#include "host/contact/solve/coupled_islands.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/contact/block_jacobi/block_jacobi.hpp"
#include "host/contact/solve/condense.hpp"
#include "host/contact/solve/feasibility.hpp"
#include "host/contact/structure/extract.hpp"

namespace tetwarp {
namespace {
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

/// Outer iterations per row of J that take as long as condensing the island. Measured: 6 to 12, on
/// slabs of 10,000 tetrahedra with 531 and 151 contacts.
constexpr std::int64_t condensing_iterations = 7;

/// Appends contacts of an island by their numbers in the problem.
void append_contacts(const std::vector<std::int32_t>& from,
                     const ContactStructure& structure,
                     const ContactIsland& island,
                     std::vector<std::int32_t>& to) {
  for (const std::int32_t c : from) {
    to.push_back(structure.contact_of_slot[index_of(island.slot_begin + c)]);
  }
}
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

void CoupledIslands::clear() {
  system_.clear();
  jacobian_.clear();
  kept_.clear();
}

void CoupledIslands::begin(const ContactProblem& problem, const ContactStructure& structure) {
  const std::vector<ContactIsland>& islands = structure.islands;
  const auto is_coupled = [](const ContactIsland& island) { return island.is_coupled; };
  if (!options_.expert.skip.constant_systems ||
      std::none_of(islands.begin(), islands.end(), is_coupled)) {
    return;
  }
  const auto is_same = [](const std::vector<double>& a, const std::vector<double>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
  };
  if (is_same(system_, problem.system.value) && is_same(jacobian_, problem.jacobian.value)) {
    return;
  }
  system_ = problem.system.value;
  jacobian_ = problem.jacobian.value;
  kept_.assign(islands.size(), {});
}

/// By the options and the size of the island.
CoupledIslands::Route CoupledIslands::planned_route(const ContactIsland& island) const {
  constexpr std::int64_t cheap = 300'000;      // entries of A^-1 J^T that take about a millisecond
  constexpr std::int64_t max_contacts = 2000;  // 290 MB for the Delassus matrix
  constexpr std::int64_t max_iterations = 1000;
  const std::int64_t budget = iteration_budget(options_, island);
  if (options_.method == ContactMethod::newton ||
      options_.expert.coupling == ContactCoupling::condensed) {
    return {0, true};
  }
  if (options_.expert.coupling == ContactCoupling::iterated) return {budget, false};
  if (options_.method != ContactMethod::automatic) return {0, true};
  const std::int64_t rows = 3 * island.contact_count();
  if (rows * (island.dof_end - island.dof_begin) < cheap) return {0, true};
  const bool fits = island.contact_count() <= max_contacts;
  return {fits ? std::min(budget, max_iterations) : budget, fits};
}

/// As planned, unless the matrix does not fit into memory; and once an island of a series with the
/// same A and J has taken as many iterations as condensing costs, it is condensed.
CoupledIslands::Route CoupledIslands::route_of(const Solve& all, std::int64_t i) const {
  const ContactIsland& island = all.islands.structure().islands[index_of(i)];
  Route route = planned_route(island);
  const std::int64_t rows = 3 * island.contact_count();
  const bool is_kept = !kept_.empty() && kept_[index_of(i)].condensation != nullptr;
  if (route.condenses && !is_kept && !all.budget.allows_memory(condensed_bytes(island))) {
    route = {iteration_budget(options_, island), false};
  }
  const bool sweeps_fast =
      rows * rows <= static_cast<std::int64_t>(all.problem.system.value.size());
  if (!kept_.empty() && route.condenses && sweeps_fast &&
      kept_[index_of(i)].outer_iterations >= condensing_iterations * rows) {
    route.outer_iterations = 0;
  }
  return route;
}

void CoupledIslands::solve_island(const Solve& all, std::int64_t i) {
  const Route route = route_of(all, i);
  IslandOutcome& outcome = all.result.outcomes[index_of(i)];
  const bool iterates = route.outer_iterations > 0;
  if (iterates) all.islands.iterate(i, route.outer_iterations, all.result);
  const bool is_solved = iterates && outcome.reason == StopReason::converged;
  const bool is_over = iterates && all.budget.is_over();
  if (!is_solved && route.condenses && !is_over) condense(all, i);
  if (!kept_.empty()) kept_[index_of(i)].outer_iterations += outcome.outer_iterations;
}

void CoupledIslands::solve(const ContactProblem& problem,
                           IslandSolver& islands,
                           SolveBudget& budget,
                           EngineResult& result) {
  const ContactStructure& structure = islands.structure();
  for (std::int64_t i = 0; i < structure.contact_islands; ++i) {
    if (structure.islands[index_of(i)].is_coupled) {
      solve_island({problem, islands, budget, result}, i);
    }
  }
}

void CoupledIslands::condense(const Solve& all, std::int64_t i) {
  EngineResult& result = all.result;
  const ContactStructure& structure = all.islands.structure();
  const ContactIsland& island = structure.islands[index_of(i)];
  const ContactProblem part = make_island_problem(all.problem, structure, island);
  std::shared_ptr<Condensation> temporary;
  std::shared_ptr<Condensation>& kept = kept_.empty() ? temporary : kept_[index_of(i)].condensation;
  if (kept == nullptr) {
    try {
      kept = std::make_shared<Condensation>(part, IslandSolver(options_, threads_, device_),
                                            &all.budget);
    } catch (const BudgetOver&) {
      // The best so far is the result of the iteration; without one, that of its first step.
      if (result.outcomes[index_of(i)].outer_iterations == 0) all.islands.iterate(i, 1, result);
      return;
    }
  } else {
    kept->problem.update(part);
    ++result.condensations_kept;
  }
  all.islands.forget_device();
  const EngineResult inner = kept->solve(&all.budget);
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
  append_contacts(inner.clamped, structure, island, result.clamped);
  append_contacts(inner.unbounded, structure, island, result.unbounded);
  result.clamped_speed = std::max(result.clamped_speed, inner.clamped_speed);
  result.unbounded_speed = std::max(result.unbounded_speed, inner.unbounded_speed);
}

}  // namespace tetwarp

/// @file contact_engine_coupled.cpp
/// The engine's part for bodies that A couples.
#include <algorithm>

#include "host/contact_condense.hpp"
#include "host/contact_coupled_newton.hpp"
#include "host/contact_engine.hpp"
#include "host/contact_extract.hpp"
#include "host/contact_outer.hpp"

namespace tetwarp {

namespace {

std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// How the contacts of coupled bodies are solved.
enum class CoupledRoute {
  outer,      ///< block-Jacobi around sweeps, as asked for
  iterative,  ///< Newton with conjugate gradients: products with A
  condensed   ///< a factorization of A, then as a problem in local form
};

/// Small Delassus matrices cost less than many products with A (measured: 192 dofs with 16 contacts
/// 1 ms, 8,190 dofs with 531 contacts over 1 s).
CoupledRoute route_of(const ContactOptions& options, const ContactIsland& island) {
  constexpr std::int64_t cheap = 300'000;  // numbers of A^-1 J^T
  switch (options.method) {
    case ContactMethod::gauss_seidel:
    case ContactMethod::anderson:
      return CoupledRoute::outer;
    case ContactMethod::nonlinear_cg:
    case ContactMethod::mass_splitting:
      return CoupledRoute::condensed;
    case ContactMethod::automatic:
    case ContactMethod::newton:
      break;
  }
  const std::int64_t dofs = island.dof_end - island.dof_begin;
  return dofs * 3 * island.contact_count() < cheap ? CoupledRoute::condensed
                                                   : CoupledRoute::iterative;
}

/// Whether a dense Delassus matrix is out of the question.
bool is_too_large(const ContactIsland& island) {
  constexpr std::int64_t most_contacts = 3000;  // 650 MB
  return island.contact_count() > most_contacts;
}

}  // namespace

void ContactEngine::solve_coupled(const ContactProblem& problem,
                                  const ContactSystem<double>& system,
                                  std::int64_t i,
                                  EngineResult& result) {
  const ContactIsland& island = structure_.islands[index_of(i)];
  IslandOutcome& outcome = result.outcomes[index_of(i)];
  const CoupledRoute route = route_of(options_, island);
  if (route != CoupledRoute::condensed) {
    outcome = iterate_coupled(problem, system, island, route == CoupledRoute::outer, result);
    const bool is_final = route == CoupledRoute::outer || is_too_large(island);
    if (outcome.reason == StopReason::converged || is_final) return;
  }
  const ContactProblem part = make_island_problem(problem, structure_, island);
  const CondensedProblem condensed(part);
  ContactEngine engine(options_, threads_, device_);
  const EngineResult inner = engine.solve(condensed.local());
  const std::vector<double> v = condensed.body_velocity(inner.impulse);
  scatter_impulses(structure_, island, inner.impulse.data(), result.impulse);
  scatter_velocities(structure_, island, v.data(), result.body_velocity);
  outcome = inner.outcomes[0];
  result.updates_skipped += inner.updates_skipped;
  result.colors = std::max(result.colors, inner.colors);
  for (const std::int32_t c : inner.clamped) {
    result.clamped.push_back(structure_.contact_of_slot[index_of(island.slot_begin + c)]);
  }
}

IslandOutcome ContactEngine::iterate_coupled(const ContactProblem& problem,
                                             const ContactSystem<double>& system,
                                             const ContactIsland& island,
                                             bool is_outer,
                                             EngineResult& result) {
  const std::vector<double> guess = gathered(
      problem.impulse_guess, 3, structure_.contact_of_slot.data(), problem.contact_count());
  CpuContactExec exec(threads_);
  CoarseSpace coarse(structure_, island);
  CoupledIsland<CpuContactExec> state(exec, options_, structure_, system, island, coarse);
  const IslandOutcome outcome =
      is_outer
          ? OuterIteration<CpuContactExec>(exec, options_, structure_, system, state).solve(guess)
          : CoupledNewton<CpuContactExec>(exec, options_, state).solve(guess);
  scatter_impulses(structure_, island, state.best_impulse().data() + 3 * island.slot_begin,
                   result.impulse);
  scatter_velocities(structure_, island, state.best_body_velocity().data() + island.dof_begin,
                     result.body_velocity);
  return outcome;
}

void ContactEngine::solve_contactless(const ContactProblem& problem,
                                      const ContactSystem<double>& system,
                                      EngineResult& result) {
  for (std::size_t i = index_of(structure_.contact_islands); i < structure_.islands.size(); ++i) {
    const ContactIsland& island = structure_.islands[i];
    if (!options_.skip.contactless_bodies && island.is_coupled) {
      iterate_coupled(problem, system, island, true, result);
      continue;
    }
    if (options_.skip.contactless_bodies) {
      result.bodies_skipped += island.block_end - island.block_begin;
    }
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

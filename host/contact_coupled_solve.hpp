/// @file contact_coupled_solve.hpp
/// Bodies that A couples: which way their contacts are solved, and the ways that need products with
/// A alone.
#pragma once
#include <cstdint>
#include <vector>

#include "host/contact_coupled_newton.hpp"
#include "host/contact_outer.hpp"

namespace tetwarp {

/// How the contacts of coupled bodies are solved.
enum class CoupledRoute {
  outer,      ///< block-Jacobi around sweeps, as asked for
  iterative,  ///< Newton with conjugate gradients
  condensed   ///< a factorization of A, then as a problem in local form
};

/// Small Delassus matrices cost less than many products with A (192 dofs with 16 contacts: 1 ms;
/// 8,190 dofs with 531 contacts: over 1 s).
inline CoupledRoute route_of(const ContactOptions& options, const ContactIsland& island) {
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
  const std::int64_t numbers = (island.dof_end - island.dof_begin) * 3 * island.contact_count();
  return numbers < cheap ? CoupledRoute::condensed : CoupledRoute::iterative;
}

/// Whether a dense Delassus matrix is out of the question.
inline bool is_too_large(const ContactIsland& island) {
  constexpr std::int64_t most_contacts = 3000;  // 650 MB
  return island.contact_count() > most_contacts;
}

/// What iterate_coupled() leaves, [3 slots] and [dofs] of the whole problem; only the island's part
/// is set.
struct CoupledResult {
  IslandOutcome outcome;
  std::vector<double> impulse;
  std::vector<double> body_velocity;
};

/// Route `outer` or `iterative`.
/// @param guess  [3 slots] to start from, or empty
/// @throws ContactProblemError  A is not positive definite
template <class Exec>
CoupledResult iterate_coupled(Exec& exec,
                              const ContactOptions& options,
                              const ContactStructure& structure,
                              const ContactSystem<double>& system,
                              const ContactIsland& island,
                              CoupledRoute route,
                              const std::vector<double>& guess) {
  CoarseSpace coarse(structure, island);
  CoupledIsland<Exec> state(exec, options, structure, system, island, coarse);
  CoupledResult result;
  if (route == CoupledRoute::outer) {
    result.outcome = OuterIteration<Exec>(exec, options, structure, system, state).solve(guess);
  } else {
    result.outcome = CoupledNewton<Exec>(exec, options, state).solve(guess);
  }
  result.impulse = state.best_impulse();
  result.body_velocity = state.best_body_velocity();
  return result;
}

}  // namespace tetwarp

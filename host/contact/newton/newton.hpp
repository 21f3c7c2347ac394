/// @file newton.hpp
/// Semismooth Newton method for contact, for problems on which sweeps converge slowly.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"

namespace tetwarp {

struct NewtonResult {
  std::int64_t iterations = 0;  ///< linear systems solved
  double eta = 0;
  double fclib = 0;
  bool converged = false;  ///< options.measure is at most options.tolerance
};

/// Which phases of newton_polish() run.
enum class NewtonPhases {
  near,  ///< the proximal points from the start, until ten linear systems do not halve the error
  far,   ///< other starts, and more proximal points
  all
};

/// Linear systems at most.
struct NewtonLimits {
  static constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
  std::int64_t shared = none;  ///< shared out between the phases; up to about twice as many in all;
                               ///< a smaller limit follows from the number of contacts
  std::int64_t total = none;   ///< of all phases; exceeded by at most a dozen
  NewtonPhases phases = NewtonPhases::all;
};

/// Limit of the linear systems of newton_polish() for a number of contacts, shared out between its
/// phases; up to about twice as many in all.
std::int64_t max_newton_steps(std::int64_t contacts);

/// Improves impulses by semismooth Newton steps on the natural map inside a proximal point
/// iteration: each outer step solves the problem with a compliance epsilon / rho added to every
/// contact, relative to the current impulses, and epsilon is lowered as long as these steps
/// converge. If this does not converge soon, it restarts from solutions of convex problems of
/// associated friction, each with the lift that follows from the sliding velocities of the previous
/// one.
///
/// Works for redundant contacts, which make the Jacobian of the problem itself singular. Returns
/// the best impulses found, never worse than the start. It is cheaper to call it for each island
/// than for several together. options.max_sweeps has no effect. Nothing is done if the factors
/// would take more memory than the budget allows.
/// @param options        law, rule, measure, tolerance and recovery_speed are read
/// @param impulse        in: start, [3 contacts], or empty: zeros; out: the best [N s]
/// @param body_velocity  out: v that the impulses cause, [dofs], m/s; empty in local form
/// @param budget         ends the iteration; null: no limits
/// @pre check_problem(problem) has passed
/// @throws ContactProblemError  A as a whole is not positive definite
///
/// Determinism: serial; same bits. Cost: a sparse LU factorization per iteration, of (3 contacts)^2
/// in local form, of (dofs)^2 in global form; there a sparse Cholesky factorization for the convex
/// problems.
/// Sources: Alart, Curnier 1991 (the map); Rockafellar 1976 (the proximal point iteration); De
/// Saxce, Feng 1998 (the lifts).
NewtonResult newton_polish(const ContactProblem& problem,
                           const ContactOptions& options,
                           std::vector<double>& impulse,
                           std::vector<double>& body_velocity,
                           SolveBudget* budget = nullptr,
                           const NewtonLimits& limits = {});

}  // namespace tetwarp

/// @file newton.hpp
/// Semismooth Newton for contact, for what sweeps leave over.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

namespace tetwarp {

struct NewtonResult {
  std::int64_t iterations = 0;  ///< linear systems solved
  double eta = 0;
  double fclib = 0;
  bool converged = false;  ///< options.measure is within options.tolerance
};

/// Improves impulses by semismooth Newton steps on the natural map, inside a proximal point
/// iteration: each outer step solves the problem with a compliance epsilon / rho added to every
/// contact, pulled towards the impulses at hand, and epsilon falls as long as that succeeds. Where
/// it does not succeed soon, the solutions of some convex problems of associated friction, each
/// lifted by what the last one slides, are tried as starts.
///
/// Redundant contacts, which make the Jacobian of the problem itself singular, do no harm. Returns
/// the best impulses met, never worse than the start. Unconnected contacts are better polished one
/// island at a time. Solves on through any number of sweeps: options.max_sweeps does not count.
/// @param options        law, rule, measure, tolerance and recovery_speed are read
/// @param impulse        in: start, [3 contacts], or empty: none; out: best [N s]
/// @param body_velocity  out: v that the impulses cause, [dofs], m/s; empty in local form
/// @pre check_problem(problem) has passed
/// @throws ContactProblemError  when A as a whole is not positive definite
///
/// Determinism: serial; same bits. Cost: a sparse LU factorization per iteration, of (3 contacts)^2
/// in local form, of (dofs)^2 in global form.
/// Sources: Alart, Curnier 1991 (the map); Rockafellar 1976 (the proximal point iteration); De
/// Saxce, Feng 1998 (the lifts).
NewtonResult newton_polish(const ContactProblem& problem,
                           const ContactOptions& options,
                           std::vector<double>& impulse,
                           std::vector<double>& body_velocity);

}  // namespace tetwarp

/// @file augmented_lagrangian.hpp
/// The method of multipliers for contacts of few bodies.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/newton/newton.hpp"
#include "host/contact/problem/budget.hpp"
#include "kernels/contact/convergence_test.hpp"

namespace tetwarp {

/// Whether solve_by_multipliers() takes an island: global form, few dofs, contacts only, law
/// `cone`, rule `parallel`, measured by eta.
/// @param dofs  of the island
bool takes_multipliers(const ContactProblem& problem,
                       const ContactOptions& options,
                       std::int64_t dofs);

/// Sweeps of an island that take about as long as one factorization of solve_by_multipliers().
double sweeps_per_multiplier_step(std::int64_t dofs, std::int64_t contacts);

/// Improves impulses by the method of multipliers: with the impulses nu of the last step, a lift
/// s = mu |u_t| and the friction cone { |nu_t| <= mu nu_n }, the velocities that minimize
///
///     v . A v / 2 - b . v + sum over contacts |P(nu - rho (u + s n))|^2 / (2 rho)
///
/// (P the projection on the cone, u = J v + w, rho far above the mass that the contact feels;
/// springs of adhesion are part of A and b) give the next impulses P(...). The function is convex
/// and has a semismooth gradient: Newton's method with a line search finds its least value in a few
/// Cholesky factorizations, from any start, also where contacts are redundant and masses differ by
/// orders of magnitude. Where contacts slide, the lifts are those of the step before, so that their
/// steps converge linearly.
/// @param criterion  of the island
/// @param impulse    in: start, [3 contacts]; out: the best [N s]
/// @param budget     ends the iteration; null: no limits
/// @pre takes_multipliers(), A couples no two bodies
/// @returns count of factorizations, and whether the best meets the criterion; its errors are not
/// set
///
/// Determinism: serial; same bits. Cost: dofs^3 / 3 operations per step.
/// Sources: Rockafellar 1976 (the method); De Saxce, Feng 1998 (the lift).
NewtonResult solve_by_multipliers(const ContactProblem& problem,
                                  const ContactOptions& options,
                                  const StopCriterion& criterion,
                                  std::vector<double>& impulse,
                                  SolveBudget* budget);

}  // namespace tetwarp

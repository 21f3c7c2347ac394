/// @file certificate.hpp
/// Certificates that contacts cannot be satisfied: impulses that cause no velocity, but that the
/// free velocities of the contacts do work against.
#pragma once
#include <optional>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"

namespace tetwarp {

/// Impulses d with d in the friction cones, B d = 0 up to rounding and q . d < 0.
///
/// For every velocity u = B r + q that impulses can cause, u . d = q . d. Without friction u_n >= 0
/// at all contacts is then impossible. With friction, contacts in the directions of d can stay
/// together only by sliding, and impulses can grow along d without bound.
struct ImpulseDirection {
  std::vector<double> impulse;  ///< d, [3 contacts], largest entry 1
  double speed = 0;             ///< -q . d over the sum of d_n [m/s]
  double distance = 0;  ///< velocities that satisfy the contacts differ from the free ones by at
                        ///< least this times what single contacts require, in the energy norm
};

enum class DirectionCone {
  normals,  ///< normal impulses only
  friction  ///< impulses in the friction cones, or pyramids
};

/// Finds such a direction by an interior point method on the contacts without springs, whose
/// impulses grow along it. The result is checked in float64 and holds whatever the method did: d is
/// in the cones exactly, and -q . d > 1e6 sqrt(d . B d  sum of min(q_n, 0)^2 / B_nn), where d . B d
/// counts as at least its own rounding.
/// @param problem  with contacts; all of one island
/// @param options  law and recovery_speed are read
/// @param budget   ends the search; null: no limits
/// @return nothing if none was found
///
/// Cost: at most 60 factorizations, as Newton's method needs one per step.
std::optional<ImpulseDirection> find_direction(const ContactProblem& problem,
                                               const ContactOptions& options,
                                               DirectionCone cone,
                                               SolveBudget* budget);

}  // namespace tetwarp

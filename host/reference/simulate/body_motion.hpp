/// @file body_motion.hpp
/// How a body of the reference moves as a whole.
#pragma once
#include <cstddef>

#include "host/reference/simulate/system.hpp"

namespace tetwarp::reference {

/// Mass, center, velocity and angular momentum about the center of a body, and its inertia.
struct BodyMotion {
  double mass = 0;
  Vector3d center = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();
  Vector3d angular_momentum = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
};
BodyMotion motion_of(const System& system, const State& state, std::size_t body);

}  // namespace tetwarp::reference

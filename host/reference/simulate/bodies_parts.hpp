/// @file bodies_parts.hpp
/// What a ReferenceBodies holds.
#pragma once
#include "host/reference/simulate/bodies.hpp"
#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/step_system.hpp"

namespace tetwarp::reference {

struct ReferenceBodies::Parts {
  System system;
  State state;
  Overrides overrides;
  Prescribed prescribed;  ///< where the state is
  std::int64_t steps = 0;
  std::optional<StepResult> last;
  double work = 0;  ///< by scripts, anchors and loads [J]
};

/// Work of the prescribed velocities, of the anchors and of the loads in a step.
double work_of(const System& system, const StepDrive& drive, const StepResult& result);

SceneEnergy energy_of(const System& system, const State& state, const Prescribed& prescribed);

/// Mass, centre, velocity and angular momentum about the centre of a body, and its inertia.
struct BodyMotion {
  double mass = 0;
  Vector3d centre = Vector3d::Zero();
  Vector3d velocity = Vector3d::Zero();
  Vector3d angular_momentum = Vector3d::Zero();
  Matrix3d inertia = Matrix3d::Zero();
};
BodyMotion motion_of(const System& system, const State& state, std::size_t body);

}  // namespace tetwarp::reference

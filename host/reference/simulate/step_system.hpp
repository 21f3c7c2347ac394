/// @file step_system.hpp
/// One step of backward Euler: A v' = b where the velocity is unknown, with A and b of assemble().
#pragma once
#include <span>
#include <vector>

#include "host/reference/simulate/assemble.hpp"

namespace tetwarp::reference {

/// What a step did, impulses [N s] by block; of angular blocks [N m s].
struct StepResult {
  State state;
  VectorXd velocity;
  VectorXd support;                      ///< A v - b where the velocity is prescribed
  std::vector<VectorXd> loads;           ///< [loads] by block
  std::vector<Vector3d> spring_impulse;  ///< [springs] on a
};

/// Velocities [3 blocks] at the end of the step without contact.
VectorXd solve_step(const System& system,
                    const State& state,
                    const StepDrive& drive,
                    const LinearSystem& linear);

/// A v - b where the velocity is prescribed, else zero.
VectorXd support_of(const System& system, const LinearSystem& linear, const VectorXd& velocity);

/// The state after a step of these velocities.
/// @param fraction  [bodies, then obstacles] of the step that each moves; empty: 1
State moved_by(const System& system,
               const State& before,
               const StepDrive& drive,
               const VectorXd& velocity,
               std::span<const double> fraction);

/// A whole step.
StepResult step_once(const System& system, const State& state, const StepDrive& drive);

}  // namespace tetwarp::reference

/// @file step_system.hpp
/// One step of backward Euler: A = M - dt dF/dv - dt^2 dF/dx, b = M v + dt F, A v' = b where the
/// velocity is unknown.
#pragma once
#include <span>

#include "host/reference/simulate/prescribed.hpp"

namespace tetwarp::reference {

/// What acts in a step from outside.
struct StepDrive {
  double time_step = 0;
  Prescribed before, after;  ///< at the start and at the end of the step
  double end_time = 0;       ///< [s], selects the loads that act
};

struct LinearSystem {
  MatrixXd matrix;  ///< A, [3 blocks][3 blocks]
  VectorXd right;   ///< b
};

/// What a step did, impulses [N s] by block; of angular blocks [N m s].
struct StepResult {
  State state;
  VectorXd velocity;
  VectorXd support;                      ///< A v - b where the velocity is prescribed
  std::vector<VectorXd> loads;           ///< [loads] by block
  std::vector<Vector3d> spring_impulse;  ///< [springs] on a
};

LinearSystem assemble(const System& system, const State& state, const StepDrive& drive);
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

/// Force of a load by block at the positions of `state`; zero outside its times.
VectorXd load_force(const System& system, const State& state, std::size_t load, double end_time);

/// A binding spring as impulse on a: constant - weight J v', J of p_a - p_b by block.
struct SpringPull {
  std::vector<PointBlock> jacobian;
  double weight = 0;
  Vector3d constant = Vector3d::Zero();
};
/// Nothing where the handle has let go.
std::optional<SpringPull> pull_of(const System& system,
                                  const State& state,
                                  const StepDrive& drive,
                                  const BindingSpring& spring);

/// exp(dt/2 omega) R with omega = R_m I^-1 R_m^T L at that rotation R_m itself, in two passes from
/// R_m = R.
Matrix3d midpoint_rotation(const RigidBody& rigid,
                           const Matrix3d& rotation,
                           const Vector3d& angular_momentum,
                           double time_step);

/// Force of elements, edges and bending on the nodes.
VectorXd elastic_force(const System& system, const State& state);

Matrix34 positions_of(const Element& element, const State& state);

}  // namespace tetwarp::reference

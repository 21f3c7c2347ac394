/// @file assemble.hpp
/// The system of a step of backward Euler: A = M - dt dF/dv - dt^2 dF/dx, b = M v + dt F.
#pragma once
#include <optional>
#include <vector>

#include "host/reference/simulate/prescribed.hpp"
#include "host/reference/simulate/system.hpp"

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
LinearSystem assemble(const System& system, const State& state, const StepDrive& drive);

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

}  // namespace tetwarp::reference

/// @file point_spring.hpp
/// Stage "forces" of a step: springs of rest length zero between points of bodies.
///
/// A point p = f(q) moves with p' = J v. J is w_a 1 for node a, and [1, -[r]x] for a rigid body, r
/// from its center of mass. With J = [J_a, -J_b] the spring adds (dt^2 k + dt c) J^T J to the
/// system and -dt k J^T (p_a - p_b) to its load. The torque r x f of a pull f turns with the arm r:
/// that adds a stiffness against rotations, see add_arm_block().
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"

namespace tetwarp {

constexpr int point_slots = 4;                 ///< blocks that a point moves with, at most
constexpr int spring_slots = 2 * point_slots;  ///< first those of a, then those of b

/// A material point, as ModelPoint: up to four nodes, a rigid body, or a place in the world.
struct SpringEnd {
  std::int32_t node[4];
  std::int32_t rigid;
  std::int32_t unused;
  double weight[4];
  double local[3];
};

struct SpringConstants {
  SpringEnd a, b;
  double stiffness;         ///< [N/m]
  double damping;           ///< [N s/m]
  std::int32_t has_anchor;  ///< b is an anchor whose place is an input of the step
};

/// Places of rigid bodies.
struct RigidPlaces {
  View<const double> center;    ///< [rigid][3] center of mass [m]
  View<const double> rotation;  ///< [rigid][4] quaternion, principal axes to world
};

struct SpringPull {
  double impulse[3];   ///< on a; b has the opposite [N s]
  double factor;       ///< dt^2 k + dt c [N s^2/m]
  double lever[2][3];  ///< r of a and b in rigid bodies, world axes [m]
};

/// One index = one spring. Writes its own entry; any order.
struct PointSpringOp {
  View<const SpringConstants> springs;
  View<const double> position;  ///< [nodes][3]
  RigidPlaces rigid;
  View<const double> anchor, anchor_velocity;  ///< [springs][3] at the end of the step
  View<const std::uint8_t> is_active;
  double time_step;
  View<SpringPull> pull;  ///< out

  TETWARP_HD void place(const SpringEnd& end, double* p, double* lever) const {
    for (int i = 0; i < 3; ++i) lever[i] = 0, p[i] = end.local[i];
    if (end.rigid >= 0) {
      double r[9];
      matrix_of_quaternion(rigid.rotation.data + 4 * std::int64_t{end.rigid}, r);
      multiply3(r, end.local, lever);
      for (int i = 0; i < 3; ++i) p[i] = rigid.center[3 * std::int64_t{end.rigid} + i] + lever[i];
    } else if (end.node[0] >= 0) {
      for (int i = 0; i < 3; ++i) p[i] = 0;
      for (int k = 0; k < 4 && end.node[k] >= 0; ++k) {
        for (int i = 0; i < 3; ++i) {
          p[i] += end.weight[k] * position[3 * std::int64_t{end.node[k]} + i];
        }
      }
    }
  }
  TETWARP_HD void operator()(std::int64_t s) const {
    const SpringConstants& own = springs[s];
    SpringPull& out = pull[s];
    double p_a[3], p_b[3];
    place(own.a, p_a, out.lever[0]);
    place(own.b, p_b, out.lever[1]);
    const double dt = time_step;
    const double k = is_active[s] ? own.stiffness : 0, c = is_active[s] ? own.damping : 0;
    out.factor = dt * (dt * k + c);
    for (int i = 0; i < 3; ++i) {
      const double to = own.has_anchor ? anchor[3 * s + i] : p_b[i];
      const double drag = own.has_anchor ? c * anchor_velocity[3 * s + i] : 0;
      out.impulse[i] = dt * (drag - k * (p_a[i] - to));
    }
  }
};

/// J of a slot: weight 1 or, for the angular velocity, -weight [lever]x; slots of b have a negative
/// weight.
struct SlotJacobian {
  double weight;
  const double* lever;  ///< null: not angular
};
TETWARP_HD SlotJacobian slot_jacobian(const SpringConstants& spring,
                                      const SpringPull& pull,
                                      int slot) {
  const bool is_b = slot >= point_slots;
  const SpringEnd& end = is_b ? spring.b : spring.a;
  const int own = is_b ? slot - point_slots : slot;
  const double sign = is_b ? -1 : 1;
  if (end.rigid < 0) return {sign * end.weight[own], nullptr};
  return {sign, own == 0 ? nullptr : pull.lever[is_b]};
}

/// x = J^T y.
TETWARP_HD void apply_transposed(const SlotJacobian& j, const double* y, double* x) {
  if (j.lever != nullptr) {
    cross3(j.lever, y, x);
  } else {
    for (int i = 0; i < 3; ++i) x[i] = y[i];
  }
  for (int i = 0; i < 3; ++i) x[i] *= j.weight;
}

/// Adds dt^2 K of a turning arm r that a force f = P / dt pulls at, to the column-major block of an
/// angular velocity. The torque changes by -((r . f) 1 - r f^T) with the rotation, as that of a
/// pendulum; K = (r . f + |r||f|) / 2 (1 - d d^T), d the direction of r / |r| + f / |f|, is that
/// where r and f are parallel, positive semidefinite, at least its symmetric part, and zero where f
/// pushes along r.
TETWARP_HD void add_arm_block(const double* r, const double* impulse, double dt, double* block) {
  const double along = root_of(dot3(r, r)), force = root_of(dot3(impulse, impulse));
  const double size = along * force, pull = 0.5 * (dot3(r, impulse) + size);
  // Not where f pushes, r or f has no direction, or the square of f is beyond all numbers.
  if (!(pull > 1e-9 * size && size < 1e150)) return;
  double d[3];
  for (int i = 0; i < 3; ++i) d[i] = r[i] / along + impulse[i] / force;
  const double square = dot3(d, d);
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      block[3 * j + i] += dt * pull * ((i == j ? 1 : 0) - d[i] * d[j] / square);
    }
  }
}

}  // namespace tetwarp

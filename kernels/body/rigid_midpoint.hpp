/// @file rigid_midpoint.hpp
/// Rigid bodies whose state is the angular momentum L: the inertia that a step uses is that of the
/// orientation half a step ahead, so that no gyroscopic term appears and a free top keeps L.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"

namespace tetwarp {

/// exp(turn) q of a rotation vector in world axes, normalized.
TETWARP_HD void turn_by_vector(const double* turn, double* q) {
  const double angle = sqrt(dot3(turn, turn));
  const double half = 0.5 * angle;
  // sin(x) / x; the series is exact to rounding below 1e-4
  const double share = angle > 1e-4 ? sin(half) / angle : 0.5 - angle * angle / 48;
  const double step[4] = {cos(half), share * turn[0], share * turn[1], share * turn[2]};
  double next[4];
  quaternion_product(step, q, next);
  normalize_quaternion(next);
  for (int i = 0; i < 4; ++i) q[i] = next[i];
}

/// M = R diag(d) R^T, [9].
TETWARP_HD void turned_diagonal(const double* r, const double* d, double* m) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      m[3 * i + j] = r[3 * i] * d[0] * r[3 * j] + r[3 * i + 1] * d[1] * r[3 * j + 1] +
                     r[3 * i + 2] * d[2] * r[3 * j + 2];
    }
  }
}

/// One index = one rigid body. Writes its own entry; any order.
struct RigidMidpointOp {
  static constexpr int resident_blocks = 2;  ///< 128 registers; the default of 64 spills

  View<const double> moments;           ///< [rigid][3] principal moments; prescribed bodies: 0
  View<const double> rotation;          ///< [rigid][4]
  View<const double> angular_momentum;  ///< [rigid][3]
  double time_step;
  View<double> inertia;  ///< out: half a step ahead, world axes, [rigid][9]

  TETWARP_HD void operator()(std::int64_t b) const {
    const double* d = moments.data + 3 * b;
    double inverse[3], q[4], r[9], spin[9], turn[3];
    for (int i = 0; i < 3; ++i) inverse[i] = d[i] > 0 ? 1 / d[i] : 0;
    matrix_of_quaternion(rotation.data + 4 * b, r);
    for (int pass = 0; pass < 2; ++pass) {
      turned_diagonal(r, inverse, spin);
      multiply3(spin, angular_momentum.data + 3 * b, turn);
      for (int i = 0; i < 3; ++i) turn[i] *= 0.5 * time_step;
      for (int i = 0; i < 4; ++i) q[i] = rotation[4 * b + i];
      turn_by_vector(turn, q);
      matrix_of_quaternion(q, r);
    }
    turned_diagonal(r, d, inertia.data + 9 * b);
  }
};

/// One index = one rigid body: x += f dt v, Q <- exp(f dt omega) Q, L = I omega.
struct RigidUpdateOp {
  View<const double> velocity;  ///< [blocks][3]
  std::int64_t first_block;     ///< of rigid bodies
  View<const double> inertia;   ///< [rigid][9]
  double time_step;
  View<const double> fraction;                      ///< f of rigid bodies, or empty: 1
  View<double> center, rotation, angular_momentum;  ///< in, out

  TETWARP_HD void operator()(std::int64_t b) const {
    const double* v = velocity.data + 3 * (first_block + 2 * b);
    const double time = fraction.size == 0 ? time_step : fraction[b] * time_step;
    double turn[3];
    for (int i = 0; i < 3; ++i) {
      center[3 * b + i] += time * v[i];
      turn[i] = time * v[3 + i];
    }
    turn_by_vector(turn, rotation.data + 4 * b);
    multiply3(inertia.data + 9 * b, v + 3, angular_momentum.data + 3 * b);
  }
};

/// One index = one number of node positions: x += f dt v.
struct NodeUpdateOp {
  View<const double> velocity;
  double time_step;
  View<const double> fraction;  ///< f of nodes, or empty: 1
  View<double> position;        ///< in, out

  TETWARP_HD void operator()(std::int64_t i) const {
    const double time = fraction.size == 0 ? time_step : fraction[i / 3] * time_step;
    position[i] += time * velocity[i];
  }
};

}  // namespace tetwarp

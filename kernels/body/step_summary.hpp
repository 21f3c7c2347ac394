/// @file step_summary.hpp
/// What the host reads after every step while the state stays in memory of a device: whether all
/// numbers are finite, the largest spin of rigid bodies, impulses and work.
#pragma once
#include <cstdint>

#include "kernels/base/plain_sums.hpp"
#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"
#include "kernels/body/point_spring.hpp"

namespace tetwarp {

/// A reduction of the state: a sum and a maximum.
struct StateCheck {
  double undefined = 0;     ///< numbers that are infinite or undefined
  double largest_spin = 0;  ///< angular velocity of a rigid body whose spin counts [rad/s]

  TETWARP_HD StateCheck& operator+=(const StateCheck& other) {
    undefined += other.undefined;
    largest_spin = max_of(largest_spin, other.largest_spin);
    return *this;
  }
};

/// One index = one node, then one rigid body.
struct StateCheckOp {
  View<const double> position;  ///< [nodes][3]
  View<const double> velocity;  ///< [blocks][3]
  RigidPlaces rigid;
  View<const double> angular_momentum;  ///< [rigid][3]
  View<const double> moments;           ///< [rigid][3] principal; 0: its spin does not count

  TETWARP_HD static double undefined_of(const double* x, int count) {
    double sum = 0;
    for (int i = 0; i < count; ++i) sum += x[i] - x[i] == 0 ? 0 : 1;
    return sum;
  }
  /// |R I^-1 R^T L| = |I^-1 R^T L|.
  TETWARP_HD double spin_of(std::int64_t r) const {
    double turn[9], square = 0;
    matrix_of_quaternion(rigid.rotation.data + 4 * r, turn);
    for (int d = 0; d < 3; ++d) {
      const double moment = moments[3 * r + d];
      double spin = 0;
      for (int i = 0; i < 3; ++i) spin += turn[3 * i + d] * angular_momentum[3 * r + i];
      spin = moment > 0 ? spin / moment : 0;
      square += spin * spin;
    }
    return sqrt(square);
  }
  TETWARP_HD StateCheck operator()(std::int64_t i) const {
    const std::int64_t nodes = position.size / 3, r = i - nodes;
    if (r < 0) {
      return {undefined_of(position.data + 3 * i, 3) + undefined_of(velocity.data + 3 * i, 3), 0};
    }
    const double undefined = undefined_of(rigid.center.data + 3 * r, 3) +
                             undefined_of(rigid.rotation.data + 4 * r, 4) +
                             undefined_of(angular_momentum.data + 3 * r, 3) +
                             undefined_of(velocity.data + 3 * (nodes + 2 * r), 6);
    return {undefined, undefined > 0 ? 0 : spin_of(r)};
  }
};

/// Impulses [N s] of a step: of supports or springs, of loads, then the work of both [J].
using ImpulseSums = PlainSums<7>;

/// One index = one node, then one rigid body, then one spring.
struct StepImpulseOp {
  std::int64_t node_count, rigid_count;
  View<const double> support, force, velocity;  ///< [blocks][3] after the step
  double time_step;
  View<const SpringConstants> springs;
  View<const SpringPull> pull;         ///< of the start of the step
  View<const double> anchor_velocity;  ///< [springs][3]

  TETWARP_HD void add_block(std::int64_t block, bool is_linear, ImpulseSums& sums) const {
    for (int i = 0; i < 3; ++i) {
      const double held = support[3 * block + i], load = time_step * force[3 * block + i];
      if (is_linear) sums.value[i] += held, sums.value[3 + i] += load;
      sums.value[6] += (held + load) * velocity[3 * block + i];
    }
  }
  TETWARP_HD void add_velocity(const SpringEnd& end,
                               const double* lever,
                               double sign,
                               double* v) const {
    if (end.rigid >= 0) {
      const double* const of = velocity.data + 3 * (node_count + 2 * std::int64_t{end.rigid});
      double turn[3];
      cross3(of + 3, lever, turn);
      for (int i = 0; i < 3; ++i) v[i] += sign * (of[i] + turn[i]);
      return;
    }
    for (int k = 0; k < point_slots && end.node[k] >= 0; ++k) {
      const double* const of = velocity.data + 3 * std::int64_t{end.node[k]};
      for (int i = 0; i < 3; ++i) v[i] += sign * end.weight[k] * of[i];
    }
  }
  /// The impulse of a spring on its point a: that of the velocities at the start, less factor J v.
  TETWARP_HD ImpulseSums of_spring(std::int64_t s) const {
    const SpringConstants& own = springs[s];
    double v[3] = {0, 0, 0};
    add_velocity(own.a, pull[s].lever[0], 1, v);
    if (!own.has_anchor) add_velocity(own.b, pull[s].lever[1], -1, v);
    ImpulseSums sums;
    for (int i = 0; i < 3; ++i) {
      sums.value[i] = pull[s].impulse[i] - pull[s].factor * v[i];
      if (own.has_anchor) sums.value[6] += sums.value[i] * anchor_velocity[3 * s + i];
    }
    return sums;
  }
  TETWARP_HD ImpulseSums operator()(std::int64_t i) const {
    ImpulseSums sums;
    if (i < node_count) {
      add_block(i, true, sums);
    } else if (i < node_count + rigid_count) {
      const std::int64_t block = node_count + 2 * (i - node_count);
      add_block(block, true, sums);
      add_block(block + 1, false, sums);
    } else {
      sums = of_spring(i - node_count - rigid_count);
    }
    return sums;
  }
};

/// One index = one listed node, then one listed rigid body: copies its position, or its center and
/// rotation.
struct PlaceCopyOp {
  View<const std::int32_t> nodes, bodies;
  View<const double> position;  ///< [nodes][3]
  RigidPlaces rigid;
  View<double> places;  ///< out: [listed nodes][3], then [listed bodies][7], center and rotation

  TETWARP_HD void operator()(std::int64_t k) const {
    if (k < nodes.size) {
      const std::int64_t n = nodes[k];
      for (int i = 0; i < 3; ++i) places[3 * k + i] = position[3 * n + i];
      return;
    }
    const std::int64_t own = k - nodes.size, r = bodies[own];
    double* const to = places.data + 3 * nodes.size + 7 * own;
    for (int i = 0; i < 3; ++i) to[i] = rigid.center[3 * r + i];
    for (int i = 0; i < 4; ++i) to[3 + i] = rigid.rotation[4 * r + i];
  }
};

}  // namespace tetwarp

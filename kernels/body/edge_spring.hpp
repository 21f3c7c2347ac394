/// @file edge_spring.hpp
/// Stage "forces" of a step: springs along the edges of cloth, force k (l - L) u.
///
/// Their block k [max(1 - L / l, 0) (1 - u u^T) + u u^T] is clamped: without the maximum the matrix
/// of a compressed sheet is not positive definite.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/body/lane_math.hpp"

namespace tetwarp {

struct EdgePull {
  double force[3];  ///< on the first node; the second has the opposite [N]
  double block[6];  ///< stiffness xx, xy, xz, yy, yz, zz [N/m]
};

/// One index = one edge. Writes its own entry; any order.
struct EdgeSpringOp {
  View<const std::int32_t> node;       ///< [edges][2]
  View<const double> stiffness;        ///< [N/m]
  View<const double> rest_length;      ///< [m]
  View<const double> position;         ///< [nodes][3]
  View<const std::uint8_t> has_moved;  ///< [nodes]
  View<EdgePull> pull;                 ///< out
  View<std::uint8_t> has_turned;       ///< out: whether a node has moved

  TETWARP_HD void operator()(std::int64_t e) const {
    const std::int64_t a = node[2 * e], b = node[2 * e + 1];
    has_turned[e] = has_moved[a] | has_moved[b];
    double u[3];
    for (int i = 0; i < 3; ++i) u[i] = position[3 * b + i] - position[3 * a + i];
    const double length = sqrt(dot3(u, u));
    for (int i = 0; i < 3; ++i) u[i] = length > 0 ? u[i] / length : 0;
    const double k = stiffness[e];
    const double across = length > rest_length[e] ? k * (1 - rest_length[e] / length) : 0;
    EdgePull& own = pull[e];
    for (int i = 0, at = 0; i < 3; ++i) {
      own.force[i] = k * (length - rest_length[e]) * u[i];
      for (int j = i; j < 3; ++j, ++at) {
        own.block[at] = (k - across) * u[i] * u[j] + (i == j ? across : 0);
      }
    }
  }
};

}  // namespace tetwarp

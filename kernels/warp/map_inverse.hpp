/// @file map_inverse.hpp
/// The inverse of a smooth map of three coordinates, by damped Newton iteration.
#pragma once
#include "kernels/base/hd.hpp"
#include "kernels/warp/tet_gradient.hpp"

namespace tetwarp {

/// Newton's step of local coordinates for a map that is `left` short of its target.
/// @returns false where the map is singular
TETWARP_HD bool newton_step(const Matrix3& gradient, const double* left, double* step) {
  const Matrix3 cofactor = cofactors(gradient);
  const double det = gradient.at[0][0] * cofactor.at[0][0] + gradient.at[0][1] * cofactor.at[0][1] +
                     gradient.at[0][2] * cofactor.at[0][2];
  if (det == 0) return false;
  const double scale = 1.0 / det;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = scale * (cofactor.at[0][axis] * left[0] + cofactor.at[1][axis] * left[1] +
                          cofactor.at[2][axis] * left[2]);
  }
  return true;
}

/// How near to its target the iteration below ends [voxel]: far below the quantum.
constexpr double map_tolerance = 0x1p-32;
constexpr int max_map_steps = 30;

/// Finds coordinates u with x(u) = `target` by damped Newton iteration from the given u. Steps are
/// halved until the distance decreases; stops where no step decreases it. Vectors of the CPU repeat
/// this order of operations (host/warp/cpu/rows/row_hex-inl.hpp).
/// @param map       (u, x, gradient): sets x(u) and dx/du
/// @param clamp     the coordinate that is taken for one
/// @param gradient  out: dx/du at the u found
/// @returns the largest distance to the target along an axis [voxel]
template <class Map, class Clamp>
TETWARP_HD double invert_map(
    const Map& map, const Clamp& clamp, const double* target, double* u, Matrix3& gradient) {
  constexpr int max_halvings = 6;
  const auto distance = [](const double* left) {
    return max_of(fabs(left[0]), max_of(fabs(left[1]), fabs(left[2])));
  };
  double x[3], left[3];
  map(u, x, gradient);
  for (int axis = 0; axis < 3; ++axis) left[axis] = target[axis] - x[axis];
  double far = distance(left);
  for (int step = 0; step < max_map_steps && far > map_tolerance; ++step) {
    double full[3];
    if (!newton_step(gradient, left, full)) return far;
    const double before = far;
    double share = 1;
    for (int halving = 0; halving <= max_halvings && far >= before; ++halving, share *= 0.5) {
      double tried[3], tried_left[3];
      Matrix3 tried_gradient;
      for (int axis = 0; axis < 3; ++axis) tried[axis] = clamp(u[axis] + share * full[axis]);
      map(tried, x, tried_gradient);
      for (int axis = 0; axis < 3; ++axis) tried_left[axis] = target[axis] - x[axis];
      if (!(distance(tried_left) < before)) continue;
      far = distance(tried_left);
      gradient = tried_gradient;
      for (int axis = 0; axis < 3; ++axis) {
        u[axis] = tried[axis];
        left[axis] = tried_left[axis];
      }
    }
    if (far >= before) return far;
  }
  return far;
}

}  // namespace tetwarp

/// @file rotations.hpp
/// Turns of vectors, and quaternions of turns and axes.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "host/scene/pose.hpp"

namespace tetwarp {

/// x turned by a unit quaternion.
inline Point3 rotate(const Quaternion& q, const Point3& x) {
  const Point3 axis{q[1], q[2], q[3]};
  const Point3 t = times(2, cross(axis, x));
  return plus(x, plus(times(q[0], t), cross(axis, t)));
}

/// The turn [rad], of at most pi, whose unit quaternion is q.
inline Point3 axis_angle_of(const Quaternion& q) {
  const double sign = q[0] < 0 ? -1 : 1;
  const Point3 axis{sign * q[1], sign * q[2], sign * q[3]};
  const double sine = norm(axis);
  return times(sine < 1e-8 ? 2.0 : 2 * std::atan2(sine, sign * q[0]) / sine, axis);
}

/// The unit quaternion, w >= 0, that turns x, y, z to three right-handed orthonormal columns.
inline Quaternion quaternion_of(const std::array<Point3, 3>& columns) {
  const auto at = [&](std::size_t row, std::size_t column) { return columns[column][row]; };
  // Four times the squares of w, x, y, z: the largest divides the others without cancellation.
  const std::array<double, 4> squares{
      1 + at(0, 0) + at(1, 1) + at(2, 2), 1 + at(0, 0) - at(1, 1) - at(2, 2),
      1 - at(0, 0) + at(1, 1) - at(2, 2), 1 - at(0, 0) - at(1, 1) + at(2, 2)};
  std::size_t largest = 0;
  for (std::size_t k = 1; k < 4; ++k) {
    if (squares[k] > squares[largest]) largest = k;
  }
  const Point3 skew{at(2, 1) - at(1, 2), at(0, 2) - at(2, 0), at(1, 0) - at(0, 1)};
  Quaternion q{};
  q[largest] = squares[largest];
  for (std::size_t k = 0; k < 3; ++k) {
    if (largest == 0) {
      q[k + 1] = skew[k];
    } else if (k + 1 == largest) {
      q[0] = skew[k];
    } else {
      q[k + 1] = at(largest - 1, k) + at(k, largest - 1);
    }
  }
  return normalized(q);
}

}  // namespace tetwarp

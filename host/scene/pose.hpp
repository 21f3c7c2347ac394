/// @file pose.hpp
/// Turns and poses: rotation matrices, quaternions (w, x, y, z) and rotation vectors.
#pragma once
#include <array>
#include <cmath>

#include <tetwarp/scene.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

using Quaternion = std::array<double, 4>;
using RotationMatrix = std::array<double, 9>;  ///< row major

/// The rotation matrix of a quaternion of any length but 0.
inline RotationMatrix rotation_of(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  const double s = 2 / (w * w + x * x + y * y + z * z);
  return {1 - s * (y * y + z * z), s * (x * y - w * z),     s * (x * z + w * y),
          s * (x * y + w * z),     1 - s * (x * x + z * z), s * (y * z - w * x),
          s * (x * z - w * y),     s * (y * z + w * x),     1 - s * (x * x + y * y)};
}

inline Point3 times(const RotationMatrix& m, const Point3& x) {
  return {m[0] * x[0] + m[1] * x[1] + m[2] * x[2], m[3] * x[0] + m[4] * x[1] + m[5] * x[2],
          m[6] * x[0] + m[7] * x[1] + m[8] * x[2]};
}

/// The unit quaternion of a turn by |axis_angle| [rad] about axis_angle.
inline Quaternion quaternion_of(const Point3& axis_angle) {
  const double angle = norm(axis_angle);
  // sin(angle / 2) / angle by its series near 0, where the quotient is not defined.
  const double factor = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
  return {std::cos(angle / 2), factor * axis_angle[0], factor * axis_angle[1],
          factor * axis_angle[2]};
}

/// The turn by b, then by a.
inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

/// The opposite turn of a unit quaternion.
inline Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

/// The same turn as a quaternion of length 1 with w >= 0.
inline Quaternion normalized(const Quaternion& q) {
  const double length = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  const double factor = (q[0] < 0 ? -1 : 1) / length;
  return {factor * q[0], factor * q[1], factor * q[2], factor * q[3]};
}

/// The pose that undoes a pose of a unit quaternion.
inline Pose inverse(const Pose& pose) {
  const Quaternion back = conjugate(pose.rotation);
  return {times(-1.0, times(rotation_of(back), pose.position)), back};
}

}  // namespace tetwarp

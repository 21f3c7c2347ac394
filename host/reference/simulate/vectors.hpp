/// @file vectors.hpp
/// Vectors, rotations and poses of the reference simulator as Eigen types.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <cstddef>

#include <tetwarp/scene.hpp>

namespace tetwarp::reference {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix34 = Eigen::Matrix<double, 3, 4>;

inline Vector3d vector_of(const Point3& p) {
  return {p[0], p[1], p[2]};
}
inline Point3 point_of(const Vector3d& v) {
  return {v(0), v(1), v(2)};
}

/// The matrix of v -> a x v.
inline Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a(2), a(1), a(2), 0, -a(0), -a(1), a(0), 0;
  return m;
}

/// exp([a]x): the turn by |a| about a.
inline Matrix3d turn_of(const Vector3d& a) {
  const double angle = a.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, a / angle).toRotationMatrix();
}

/// The vector a with |a| <= pi of which turn_of() makes R.
inline Vector3d axis_angle_of(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

inline Matrix3d rotation_of(const std::array<double, 4>& q) {
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
}

/// Unit quaternion w, x, y, z of a rotation, w >= 0.
inline std::array<double, 4> quaternion_of(const Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  return {q.w(), q.x(), q.y(), q.z()};
}

/// A rigid placement: x_world = position + rotation x.
struct Placement {
  Vector3d position = Vector3d::Zero();
  Matrix3d rotation = Matrix3d::Identity();

  Vector3d operator()(const Vector3d& x) const { return position + rotation * x; }
};

inline Placement placement_of(const Pose& pose) {
  return {vector_of(pose.position), rotation_of(pose.rotation)};
}

}  // namespace tetwarp::reference

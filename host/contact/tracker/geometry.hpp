/// @file geometry.hpp
/// Conversion between body and world coordinates, and contact frames.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

inline Eigen::Vector3d vector_of(const Point3& point) {
  return {point[0], point[1], point[2]};
}

inline Point3 point_of(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

inline Eigen::Quaterniond rotation_of(const BodyPose& pose) {
  const auto& [w, x, y, z] = pose.rotation;
  return {w, x, y, z};
}

/// A point of a body, in world coordinates.
inline Eigen::Vector3d world_of(const BodyPose& pose, const Point3& point) {
  return vector_of(pose.position) + rotation_of(pose) * vector_of(point);
}

/// A world position, in coordinates of a body.
inline Point3 body_of(const BodyPose& pose, const Eigen::Vector3d& world) {
  return point_of(rotation_of(pose).conjugate() * (world - vector_of(pose.position)));
}

/// The last reported normal [world], unit: the mean of its images under the two bodies' rotations.
inline Eigen::Vector3d carried_normal(const ContactRecord& record,
                                      const BodyPose& pose_a,
                                      const BodyPose& pose_b) {
  const Eigen::Vector3d sum = rotation_of(pose_a) * vector_of(record.normal_a) +
                              rotation_of(pose_b) * vector_of(record.normal_b);
  return sum.norm() > 0 ? sum.normalized() : rotation_of(pose_a) * vector_of(record.normal_a);
}

/// Tangent 1: `direction` projected onto the plane of the unit `normal`, normalized; where the
/// projection vanishes, that of the coordinate axis with the largest angle to the normal.
inline Eigen::Vector3d tangent_of(const Eigen::Vector3d& normal, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d across = direction - normal.dot(direction) * normal;
  if (across.norm() > 1e-9 * direction.norm()) return across.normalized();
  Eigen::Index axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Eigen::Vector3d unit = Eigen::Vector3d::Unit(axis);
  return (unit - normal.dot(unit) * normal).normalized();
}

}  // namespace tetwarp

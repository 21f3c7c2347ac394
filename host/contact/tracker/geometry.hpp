/// @file geometry.hpp
/// Conversion between body and world coordinates, and contact frames.
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <span>
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

inline const BodyPlace& place_of(std::span<const BodyPlace> places, std::int32_t body) {
  return places[static_cast<std::size_t>(body)];
}

/// A material point of a deformable body, in world coordinates.
inline Eigen::Vector3d world_of(std::span<const Point3> vertices, const MaterialPoint& point) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 3 && point.vertex[k] >= 0; ++k) {
    sum += point.weight[k] * vector_of(vertices[static_cast<std::size_t>(point.vertex[k])]);
  }
  return sum;
}

/// An anchor in world coordinates: `local` of a rigid body, `material` of a deformable one.
inline Eigen::Vector3d anchor_world(const BodyPlace& place,
                                    const Point3& local,
                                    const MaterialPoint& material) {
  return place.is_rigid() ? world_of(place.pose, local) : world_of(place.vertices, material);
}

/// The axes of a body at a material point, as columns: of a rigid body its own; of a deformable one
/// those of the triangle of the point's vertices: along the first edge, across it, normal. None
/// where there are less than three vertices, or no triangle.
inline std::optional<Eigen::Matrix3d> axes_at(const BodyPlace& place, const MaterialPoint& point) {
  if (place.is_rigid()) return rotation_of(place.pose).toRotationMatrix();
  if (point.vertex[2] < 0) return {};
  Eigen::Vector3d corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = vector_of(place.vertices[static_cast<std::size_t>(point.vertex[k])]);
  }
  const Eigen::Vector3d along = corner[1] - corner[0];
  const Eigen::Vector3d normal = along.cross(corner[2] - corner[0]);
  if (!(along.norm() > 0 && normal.norm() > 0)) return {};
  Eigen::Matrix3d axes;
  axes.col(0) = along.normalized();
  axes.col(2) = normal.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

/// A direction that the material carries, in world axes; zero without axes there.
inline Eigen::Vector3d carried(const BodyPlace& place,
                               const MaterialPoint& point,
                               const Point3& direction) {
  if (place.is_rigid()) return rotation_of(place.pose) * vector_of(direction);
  const std::optional<Eigen::Matrix3d> axes = axes_at(place, point);
  return axes ? Eigen::Vector3d(*axes * vector_of(direction)) : Eigen::Vector3d::Zero();
}

/// Whether neither side has axes of its own, so that normal_a is in world axes.
inline bool has_world_normal(const ContactRecord& record) {
  return record.normal_b == Point3{0, 0, 0} && !record.material_a.is_rigid() &&
         record.material_a.vertex[2] < 0;
}

/// The last reported normal [world], unit: the mean of those that the two bodies carry.
inline Eigen::Vector3d carried_normal(const ContactRecord& record,
                                      const BodyPlace& place_a,
                                      const BodyPlace& place_b) {
  if (has_world_normal(record)) return vector_of(record.normal_a);
  const Eigen::Vector3d of_a = carried(place_a, record.material_a, record.normal_a);
  const Eigen::Vector3d sum = of_a + carried(place_b, record.material_b, record.normal_b);
  if (sum.norm() > 0) return sum.normalized();
  return of_a.norm() > 0 ? of_a : vector_of(record.normal_world);
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

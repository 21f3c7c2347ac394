/// @file record_update.cpp
/// Moves anchors and normals of a record with the material points of its bodies.
#include "host/contact/tracker/record_update.hpp"

#include <algorithm>
#include <cmath>

namespace tetwarp {
namespace {
using Eigen::Vector3d;

/// A normal [world] in coordinates of a body at a material point; zero where it has no axes.
Point3 local_normal(const BodyPlace& place, const MaterialPoint& point, const Vector3d& normal) {
  if (place.is_rigid()) return point_of(rotation_of(place.pose).conjugate() * normal);
  const std::optional<Eigen::Matrix3d> axes = axes_at(place, point);
  return axes ? point_of(axes->transpose() * normal) : Point3{0, 0, 0};
}

void set_normal(ContactRecord& record,
                const Vector3d& normal,
                const MaterialPoint& material_a,
                const MaterialPoint& material_b,
                const BodyPlace& place_a,
                const BodyPlace& place_b) {
  record.normal_a = local_normal(place_a, material_a, normal);
  record.normal_b = local_normal(place_b, material_b, normal);
  if (has_world_normal(record)) record.normal_a = point_of(normal);
}

/// Sets the anchors to the reported points.
void set_anchors(ContactRecord& record,
                 const ReportedContact& report,
                 const Vector3d& normal,
                 const BodyPlace& place_a,
                 const BodyPlace& place_b) {
  const Vector3d point_a = vector_of(report.point_a_world);
  const Vector3d point_b = vector_of(report.point_b_world);
  record.standoff = 0;
  if (place_a.is_rigid()) {
    record.anchor_a = body_of(place_a.pose, point_a);
  } else {
    record.material_a = report.material_a;
    record.standoff += normal.dot(world_of(place_a.vertices, report.material_a) - point_a);
  }
  if (place_b.is_rigid()) {
    record.anchor_b = body_of(place_b.pose, point_b);
  } else {
    record.material_b = report.material_b;
    record.standoff -= normal.dot(world_of(place_b.vertices, report.material_b) - point_b);
  }
}

Vector3d apart(const ContactRecord& record, const BodyPlace& place_a, const BodyPlace& place_b) {
  return anchor_world(place_a, record.anchor_a, record.material_a) -
         anchor_world(place_b, record.anchor_b, record.material_b);
}

Vector3d across(const Vector3d& vector, const Vector3d& normal) {
  return vector - normal.dot(vector) * normal;
}

/// Moves a material point in the plane of its triangle, so that it moves by `way` across `normal`.
/// @returns how far it moves along the normal
double move_material(const BodyPlace& place,
                     MaterialPoint& point,
                     const Eigen::Matrix3d& axes,
                     const Vector3d& way,
                     const Vector3d& normal) {
  const Vector3d plane = axes.col(2);
  const double cosine = plane.dot(normal);
  const bool is_steep = std::abs(cosine) < 0.1;  // a triangle on edge: the nearest way in its plane
  const double along = is_steep ? 0 : -plane.dot(way) / cosine;
  const Vector3d moved =
      is_steep ? Vector3d(way - plane.dot(way) * plane) : Vector3d(way + along * normal);
  Vector3d corner[3];
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = vector_of(place.vertices[static_cast<std::size_t>(point.vertex[k])]);
  }
  const Vector3d edge_b = corner[1] - corner[0], edge_c = corner[2] - corner[0];
  const double double_area = edge_b.cross(edge_c).dot(plane);
  const double step_b = moved.cross(edge_c).dot(plane) / double_area;
  const double step_c = edge_b.cross(moved).dot(plane) / double_area;
  point.weight[0] -= step_b + step_c;
  point.weight[1] += step_b;
  point.weight[2] += step_c;
  return normal.dot(moved);
}

/// @returns whether the body has an anchor that can move
bool move_side(const BodyPlace& place,
               Point3& local,
               MaterialPoint& material,
               const Vector3d& way,
               const Vector3d& normal,
               double& along) {
  along = 0;
  if (place.is_rigid()) {
    local = body_of(place.pose, world_of(place.pose, local) + way);
    return true;
  }
  const std::optional<Eigen::Matrix3d> axes = axes_at(place, material);
  if (axes) along = move_material(place, material, *axes, way, normal);
  return axes.has_value();
}

/// The bond of an earlier step covers a part of what touches now.
void spread_bond(ContactRecord& record,
                 const ReportedContact& report,
                 const Vector3d& normal,
                 std::span<const BodyPlace> places) {
  const BodyPlace& place_a = place_of(places, report.key.body_a);
  const BodyPlace& place_b = place_of(places, report.key.body_b);
  const Vector3d before = across(apart(record, place_a, place_b), normal);
  record.intensity *= report.bonded_share;
  set_anchors(record, report, normal, place_a, place_b);
  const Vector3d after = across(apart(record, place_a, place_b), normal);
  move_anchor(record, after - before, normal, places);
}
}  // namespace

void update_record(ContactRecord& record,
                   const ReportedContact& report,
                   std::span<const BodyPlace> places,
                   const ContactTrackerOptions& options) {
  const BodyPlace& place_a = place_of(places, report.key.body_a);
  const BodyPlace& place_b = place_of(places, report.key.body_b);
  const Vector3d normal = vector_of(report.normal).normalized();
  record.key = report.key;
  record.material = report.material;
  record.area = report.area;
  if (record.intensity > 0) {
    if (report.bonded_share < 1) spread_bond(record, report, normal, places);
    set_normal(record, normal, record.material_a, record.material_b, place_a, place_b);
    return;
  }
  set_anchors(record, report, normal, place_a, place_b);
  set_normal(record, normal, record.material_a, record.material_b, place_a, place_b);
  const double gap = normal.dot(vector_of(report.point_a_world) - vector_of(report.point_b_world));
  if (!record.has_touched && record.area > 0 && gap <= options.touch_distance) {
    record.has_touched = true;
    record.intensity =
        options.materials[static_cast<std::size_t>(record.material)].initial_intensity;
  }
}

TrackedContact contact_of(const ContactRecord& record,
                          const ReportedContact* report,
                          std::span<const BodyPlace> places) {
  const BodyPlace& place_a = place_of(places, record.key.body_a);
  const BodyPlace& place_b = place_of(places, record.key.body_b);
  const Vector3d anchor_a = anchor_world(place_a, record.anchor_a, record.material_a);
  const Vector3d anchor_b = anchor_world(place_b, record.anchor_b, record.material_b);
  const Vector3d point_a = report != nullptr ? vector_of(report->point_a_world) : anchor_a;
  const Vector3d point_b = report != nullptr ? vector_of(report->point_b_world) : anchor_b;
  const Vector3d normal = report != nullptr ? vector_of(report->normal).normalized()
                                            : carried_normal(record, place_a, place_b);
  const Vector3d tangent =
      tangent_of(normal, report != nullptr ? vector_of(report->tangent) : Vector3d::Zero());
  const Vector3d other = normal.cross(tangent);
  // Without adhesion the anchors are the reported points, and there are no tangential gaps.
  const Vector3d shift = record.intensity > 0 ? Vector3d(anchor_a - anchor_b) : Vector3d::Zero();
  const double standoff = report != nullptr ? 0 : record.standoff;
  TrackedContact contact;
  contact.key = record.key;
  contact.point_a_world = point_of(point_a);
  contact.point_b_world = point_of(point_b);
  if (!place_a.is_rigid()) {
    contact.material_a = report != nullptr ? report->material_a : record.material_a;
  }
  if (!place_b.is_rigid()) {
    contact.material_b = report != nullptr ? report->material_b : record.material_b;
  }
  contact.axes = {point_of(normal), point_of(tangent), point_of(other)};
  contact.gap = {normal.dot(point_a - point_b) - standoff, tangent.dot(shift), other.dot(shift)};
  contact.is_reported = report != nullptr;
  return contact;
}

void move_anchor(ContactRecord& record,
                 const Vector3d& way,
                 const Vector3d& normal,
                 std::span<const BodyPlace> places) {
  const BodyPlace& place_a = place_of(places, record.key.body_a);
  const BodyPlace& place_b = place_of(places, record.key.body_b);
  double along = 0;
  if (move_side(place_b, record.anchor_b, record.material_b, way, normal, along)) {
    record.standoff -= along;
  } else if (move_side(place_a, record.anchor_a, record.material_a, -way, normal, along)) {
    record.standoff += along;
  }
}

void shrink_gap(ContactRecord& record, double keep, std::span<const BodyPlace> places) {
  const BodyPlace& place_a = place_of(places, record.key.body_a);
  const BodyPlace& place_b = place_of(places, record.key.body_b);
  const Vector3d normal = carried_normal(record, place_a, place_b);
  const Vector3d sideways = across(apart(record, place_a, place_b), normal);
  move_anchor(record, (1 - keep) * sideways, normal, places);
}

}  // namespace tetwarp

#include "tests/support/rigid_bodies.hpp"

#include <algorithm>
#include <cmath>

#include "host/contact/tracker/geometry.hpp"

namespace tetwarp::test {
namespace {
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

Matrix3d world_inertia(const RigidBox& box) {
  const Matrix3d rotation = rotation_of(box.pose).toRotationMatrix();
  return rotation * box.inertia.asDiagonal() * rotation.transpose();
}

/// Spin after a step of free tumbling: I (w - w0) + dt w x I w = 0 in world axes of the start.
/// Multiplied by w this shows that the energy cannot grow.
Vector3d tumbled_spin(const Matrix3d& inertia, const Vector3d& start, double time_step) {
  Vector3d spin = start;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Vector3d momentum = inertia * spin;
    const Vector3d error = inertia * (spin - start) + time_step * spin.cross(momentum);
    const Matrix3d slope =
        inertia + time_step * (cross_matrix(spin) * inertia - cross_matrix(momentum));
    const Vector3d change = slope.lu().solve(error);
    spin -= change;
    if (change.norm() <= 1e-15 * spin.norm()) break;
  }
  return spin;
}

void push_row(SparseMatrix& matrix) {
  if (matrix.row_start.empty()) matrix.row_start.push_back(0);
  matrix.row_start.push_back(static_cast<std::int64_t>(matrix.column.size()));
  matrix.rows = static_cast<std::int64_t>(matrix.row_start.size()) - 1;
}

void push(SparseMatrix& matrix, std::size_t column, double value) {
  matrix.column.push_back(static_cast<std::int32_t>(column));
  matrix.value.push_back(value);
}
}  // namespace

RigidBox make_box(const Vector3d& half_extents, double mass, int points_per_edge) {
  const Vector3d squared = half_extents.cwiseAbs2();
  RigidBox box{half_extents, mass, mass / 3 * (Vector3d::Constant(squared.sum()) - squared), {}};
  const double area = 4 * half_extents.x() * half_extents.y() / (points_per_edge * points_per_edge);
  const auto along = [&](int i) {
    return points_per_edge == 1 ? 0 : 2.0 * i / (points_per_edge - 1) - 1;
  };
  for (const double side : {-1.0, 1.0}) {
    for (int i = 0; i < points_per_edge; ++i) {
      for (int j = 0; j < points_per_edge; ++j) {
        box.points.push_back({half_extents.cwiseProduct(Vector3d(along(i), along(j), side)), area});
      }
    }
  }
  return box;
}

std::vector<BodyPose> RigidWorld::poses() const {
  std::vector<BodyPose> poses(1);
  for (const RigidBox& box : boxes) poses.push_back(box.pose);
  return poses;
}

void RigidWorld::report_plane(std::size_t p, std::vector<ReportedContact>& reports) const {
  const Plane& plane = planes[p];
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    for (std::size_t i = 0; i < boxes[b].points.size(); ++i) {
      const SurfacePoint& point = boxes[b].points[i];
      const Vector3d world = world_of(boxes[b].pose, point_of(point.position));
      const double gap = plane.normal.dot(world - plane.point);
      if (gap > options_.margin) continue;
      ReportedContact report;
      report.key = {0, static_cast<std::int32_t>(p), static_cast<std::int32_t>(b + 1),
                    static_cast<std::int32_t>(i)};
      report.point_a_world = point_of(world - gap * plane.normal);
      report.point_b_world = point_of(world);
      report.normal = point_of(-plane.normal);
      report.area = point.area;
      report.material = plane.material;
      reports.push_back(report);
    }
  }
}

void RigidWorld::report_pair(std::size_t pointed,
                             std::size_t faced,
                             std::vector<ReportedContact>& reports) const {
  const RigidBox& face_box = boxes[faced];
  const Vector3d half = face_box.half_extents;
  for (std::size_t i = 0; i < boxes[pointed].points.size(); ++i) {
    const SurfacePoint& point = boxes[pointed].points[i];
    const Vector3d world = world_of(boxes[pointed].pose, point_of(point.position));
    const Vector3d local = vector_of(body_of(face_box.pose, world));
    const double side = local.z() < 0 ? -1 : 1;
    const double gap = side * local.z() - half.z();
    const bool is_beside = std::abs(local.x()) > half.x() + options_.margin ||
                           std::abs(local.y()) > half.y() + options_.margin;
    if (is_beside || std::abs(gap) > options_.margin) continue;
    const Vector3d normal = side * (rotation_of(face_box.pose) * Vector3d::UnitZ());
    const auto face = static_cast<std::int32_t>(face_box.points.size()) + (side > 0 ? 1 : 0);
    ReportedContact report;
    report.key = {static_cast<std::int32_t>(pointed + 1), static_cast<std::int32_t>(i),
                  static_cast<std::int32_t>(faced + 1), face};
    report.point_a_world = point_of(world);
    report.point_b_world = point_of(world - gap * normal);
    report.normal = point_of(normal);
    report.area = point.area;
    report.material = options_.box_material;
    reports.push_back(report);
  }
}

std::vector<ReportedContact> RigidWorld::report() const {
  std::vector<ReportedContact> reports;
  for (std::size_t p = 0; p < planes.size(); ++p) report_plane(p, reports);
  const auto face_area = [&](std::size_t b) {
    return boxes[b].half_extents.x() * boxes[b].half_extents.y();
  };
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = a + 1; b < boxes.size(); ++b) {
      const bool is_b_smaller = face_area(b) <= face_area(a);
      report_pair(is_b_smaller ? b : a, is_b_smaller ? a : b, reports);
    }
  }
  return reports;
}

void RigidWorld::assemble() {
  problem_ = {};
  const std::size_t dofs = 6 * boxes.size();
  problem_.system.columns = problem_.jacobian.columns = static_cast<std::int64_t>(dofs);
  problem_.jacobian.row_start = {0};
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    const RigidBox& box = boxes[b];
    problem_.block_start.push_back(static_cast<std::int32_t>(6 * b));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      push(problem_.system, 6 * b + axis, box.mass);
      push_row(problem_.system);
    }
    const Matrix3d inertia = world_inertia(box);
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) {
        push(problem_.system, 6 * b + 3 + static_cast<std::size_t>(column), inertia(row, column));
      }
      push_row(problem_.system);
    }
    const Vector3d force = box.mass * options_.gravity + box.force;
    const Vector3d linear = box.mass * box.velocity + options_.time_step * force;
    const Vector3d angular = inertia * tumbled_spin(inertia, box.spin, options_.time_step);
    problem_.load.insert(problem_.load.end(), linear.begin(), linear.end());
    problem_.load.insert(problem_.load.end(), angular.begin(), angular.end());
  }
  problem_.block_start.push_back(static_cast<std::int32_t>(dofs));

  // u = v_a(point a) - v_b(point b): per axis e the row is e on a velocity, arm x e on a spin.
  for (const TrackedContact& contact : contacts_) {
    for (const Point3& axis : contact.axes) {
      const auto push_body = [&](std::int32_t body, const Point3& point, double sign) {
        if (body == 0) return;  // the planes do not move
        const auto b = static_cast<std::size_t>(body - 1);
        const Vector3d along = sign * vector_of(axis);
        const Vector3d arm = vector_of(point) - vector_of(boxes[b].pose.position);
        const Vector3d turning = arm.cross(along);
        for (std::size_t k = 0; k < 3; ++k) {
          push(problem_.jacobian, 6 * b + k, along(static_cast<Eigen::Index>(k)));
        }
        for (std::size_t k = 0; k < 3; ++k) {
          push(problem_.jacobian, 6 * b + 3 + k, turning(static_cast<Eigen::Index>(k)));
        }
      };
      push_body(contact.key.body_a, contact.point_a_world, 1);
      push_body(contact.key.body_b, contact.point_b_world, -1);
      push_row(problem_.jacobian);
    }
  }
  tracker.fill(problem_);
}

void RigidWorld::move(const std::vector<double>& body_velocity) {
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    RigidBox& box = boxes[b];
    box.velocity = Vector3d::Map(&body_velocity[6 * b]);
    box.spin = Vector3d::Map(&body_velocity[6 * b + 3]);
    box.pose.position = point_of(vector_of(box.pose.position) + options_.time_step * box.velocity);
    // Turning about the spin itself leaves its body coordinates, and so the energy, as they are.
    const double angle = options_.time_step * box.spin.norm();
    if (angle == 0) continue;
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, box.spin.normalized()));
    const Eigen::Quaterniond rotation = (turn * rotation_of(box.pose)).normalized();
    box.pose.rotation = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  }
}

const ContactSolution& RigidWorld::step() {
  contacts_ = tracker.begin_step(report(), poses(), options_.time_step);
  assemble();
  solution_ = solver_.solve(problem_);
  move(solution_.body_velocity);
  tracker.end_step(solution_, poses());
  time_ += options_.time_step;
  return solution_;
}

double RigidWorld::kinetic_energy() const {
  double energy = 0;
  for (const RigidBox& box : boxes) {
    energy += box.mass / 2 * box.velocity.squaredNorm();
    energy += box.spin.dot(world_inertia(box) * box.spin) / 2;
  }
  return energy;
}

double RigidWorld::spring_energy() const {
  const std::vector<BodyPose> bodies = poses();
  double energy = 0;
  for (const ContactRecord& record : tracker.records()) {
    const ContactMaterial& material =
        options_.tracking.materials[static_cast<std::size_t>(record.material)];
    const BodyPose& pose_a = bodies[static_cast<std::size_t>(record.key.body_a)];
    const BodyPose& pose_b = bodies[static_cast<std::size_t>(record.key.body_b)];
    const Vector3d normal = carried_normal(record, BodyPlace{pose_a}, BodyPlace{pose_b});
    const Vector3d apart = world_of(pose_a, record.anchor_a) - world_of(pose_b, record.anchor_b);
    const double gap = std::max(normal.dot(apart), 0.0);
    const double slip = (apart - normal.dot(apart) * normal).squaredNorm();
    const double sideways = material.tangential_stiffness.value_or(material.stiffness) * slip;
    energy += record.area / 2 * record.intensity * record.intensity *
              (material.stiffness * gap * gap + sideways);
  }
  return energy;
}

double RigidWorld::energy() const {
  double energy = kinetic_energy() + spring_energy();
  for (const RigidBox& box : boxes) {
    energy -= (box.mass * options_.gravity + box.force).dot(vector_of(box.pose.position));
  }
  return energy;
}

}  // namespace tetwarp::test

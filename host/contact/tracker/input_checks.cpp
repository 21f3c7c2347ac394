#include "host/contact/tracker/input_checks.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>

#include "host/contact/problem/checks.hpp"
#include "host/contact/tracker/geometry.hpp"

namespace tetwarp {
namespace {
bool are_finite(std::initializer_list<Point3> points) {
  return std::all_of(points.begin(), points.end(), [](const Point3& point) {
    return std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
  });
}
}  // namespace

void refuse(const std::string& subject, const std::string& problem) {
  throw std::invalid_argument("ContactTracker: " + subject + " " + problem);
}

std::string name_of(const ContactKey& key) {
  return "contact (" + std::to_string(key.body_a) + ", " + std::to_string(key.feature_a) + ", " +
         std::to_string(key.body_b) + ", " + std::to_string(key.feature_b) + ")";
}

void check_materials(const std::vector<ContactMaterial>& materials) {
  for (std::size_t m = 0; m < materials.size(); ++m) {
    const ContactMaterial& material = materials[m];
    for (const double value :
         {material.friction, material.stiffness, material.tangential_stiffness.value_or(0),
          material.energy, material.viscosity, material.bonding_rate, material.saturation_pressure,
          material.initial_intensity, 1 - material.initial_intensity, material.restitution,
          1 - material.restitution}) {
      if (std::isfinite(value) && value >= 0) continue;
      refuse(
          "material " + std::to_string(m),
          "has a constant that is negative or not finite, or an intensity or a restitution above "
          "1");
    }
  }
}

void check_bodies(const ContactKey& key, std::size_t body_count) {
  if (key.body_a == key.body_b) refuse(name_of(key), "has the same body on both sides");
  if (key.body_a < 0 || static_cast<std::size_t>(key.body_b) >= body_count) {
    refuse(name_of(key),
           "has a body index out of range, there are " + std::to_string(body_count) + " poses");
  }
}

void check_report(const ReportedContact& report,
                  std::size_t body_count,
                  std::size_t material_count) {
  check_bodies(report.key, body_count);
  if (!(std::abs(vector_of(report.normal).norm() - 1) <= 1e-6)) {
    refuse(name_of(report.key), "has a normal that is not a unit vector");
  }
  if (!(report.area >= 0) || !std::isfinite(report.area)) {
    refuse(name_of(report.key),
           "has area " + std::to_string(report.area) + ", expected a finite number of 0 or more");
  }
  if (report.material < 0 || static_cast<std::size_t>(report.material) >= material_count) {
    refuse(name_of(report.key), "has material " + std::to_string(report.material) + ", there are " +
                                    std::to_string(material_count) + " materials");
  }
  if (!are_finite({report.point_a_world, report.point_b_world, report.tangent})) {
    refuse(name_of(report.key), "has a position or tangent that is not finite");
  }
  if (!are_finite({report.surface_velocity, report.obstacle_velocity}) ||
      !std::isfinite(report.approach_speed)) {
    refuse(name_of(report.key), "has a velocity that is not finite");
  }
}

void check_records(const std::vector<ContactRecord>& records, std::size_t material_count) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    const ContactRecord& record = records[k];
    if (k > 0 && !(records[k - 1].key < record.key)) {
      refuse(name_of(record.key), "is out of order, sort the records by key");
    }
    if (!(record.key.body_a < record.key.body_b)) {
      refuse(name_of(record.key), "must name the body with the smaller index first");
    }
    if (!(record.intensity >= 0 && record.intensity <= 1) || record.material < 0 ||
        static_cast<std::size_t>(record.material) >= material_count) {
      refuse(name_of(record.key),
             "has an intensity outside [0, 1] or a material index out of range");
    }
    if (!(record.area >= 0) || !std::isfinite(record.area) ||
        !are_finite({record.anchor_a, record.anchor_b, record.normal_a, record.normal_b,
                     record.impulse_world})) {
      refuse(name_of(record.key), "has a negative area or a number that is not finite");
    }
  }
}

void check_poses(std::span<const BodyPose> poses) {
  for (std::size_t b = 0; b < poses.size(); ++b) {
    const std::string name = "the pose of body " + std::to_string(b);
    if (!are_finite({poses[b].position})) refuse(name, "has a position that is not finite");
    const double length = rotation_of(poses[b]).norm();
    if (std::abs(length - 1) <= 1e-6) continue;
    refuse(name, "has a rotation of length " + text_of(length) +
                     ", expected 1 within 1e-6: normalize the quaternion");
  }
}

void check_solution(const ContactSolution& solution, const std::vector<TrackedContact>& contacts) {
  const auto check = [&](const char* name, const std::vector<double>& values) {
    if (values.size() != 3 * contacts.size()) {
      refuse(std::string("solution.") + name, "has " + std::to_string(values.size()) +
                                                  " numbers, expected 3 for each of " +
                                                  std::to_string(contacts.size()) + " contacts");
    }
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::isfinite(values[row])) continue;
      refuse(std::string("solution.") + name,
             "of " + name_of(contacts[row / 3].key) + " is " + text_of(values[row]) +
                 ", expected a finite number; do not pass on a solve that failed");
    }
  };
  check("impulse", solution.impulse);
  check("velocity", solution.velocity);
}

}  // namespace tetwarp

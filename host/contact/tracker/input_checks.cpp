/// @file input_checks.cpp
/// Checks of bodies, materials, reports and records.
#include "host/contact/tracker/input_checks.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>

#include "host/base/parallel.hpp"
#include "host/contact/problem/checks.hpp"
#include "host/contact/tracker/geometry.hpp"

namespace tetwarp {
namespace {
bool are_finite(std::initializer_list<Point3> points) {
  return std::all_of(points.begin(), points.end(), [](const Point3& point) {
    return std::all_of(point.begin(), point.end(), [](double x) { return std::isfinite(x); });
  });
}

/// @param place  of the body; a rigid one has no vertices
void check_material(const ContactKey& key, const BodyPlace& place, const MaterialPoint& point) {
  if (place.is_rigid()) return;
  double sum = 0;
  bool is_good = point.vertex[0] >= 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t vertex = point.vertex[k];
    if (vertex < 0) continue;
    is_good = is_good && static_cast<std::size_t>(vertex) < place.vertices.size() &&
              (k == 0 || point.vertex[k - 1] >= 0);
    sum += point.weight[k];
  }
  if (is_good && std::abs(sum - 1) <= 1e-6) return;
  refuse(key, "needs a material point on its deformable body: one to three of the body's " +
                  std::to_string(place.vertices.size()) + " vertices, with weights of sum 1");
}

void check_place(std::size_t body, const BodyPlace& place) {
  if (!place.is_rigid()) {
    // Without a way out of the loop, so that compilers make vectors of it.
    constexpr double most = std::numeric_limits<double>::max();
    bool is_bad = false;
    for (const Point3& vertex : place.vertices) {
      for (const double x : vertex) is_bad |= !(std::abs(x) <= most);
    }
    if (is_bad) refuse("body " + std::to_string(body), "has a vertex whose position is not finite");
    return;
  }
  const BodyPose& pose = place.pose;
  if (are_finite({pose.position}) && std::abs(rotation_of(pose).norm() - 1) <= 1e-6) return;
  const std::string name = "the pose of body " + std::to_string(body);
  if (!are_finite({pose.position})) refuse(name, "has a position that is not finite");
  const double length = rotation_of(pose).norm();
  refuse(name, "has a rotation of length " + text_of(length) +
                   ", expected 1 within 1e-6: normalize the quaternion");
}

void check_bodies(const ContactKey& key, std::span<const BodyPlace> places) {
  const auto is_out = [&](std::int32_t body) {
    return body < 0 || static_cast<std::size_t>(body) >= places.size();
  };
  if (is_out(key.body_a) || is_out(key.body_b)) {
    refuse(key,
           "has a body index out of range, there are " + std::to_string(places.size()) + " bodies");
  }
  if (key.body_a != key.body_b) return;
  if (place_of(places, key.body_a).is_rigid() || key.feature_a == key.feature_b) {
    refuse(key, "has the same body on both sides");
  }
}
}  // namespace

void refuse(const std::string& subject, const std::string& problem) {
  throw std::invalid_argument("ContactTracker: " + subject + " " + problem);
}
void refuse(const ContactKey& key, const std::string& problem) {
  throw ContactKeyError(key, "ContactTracker: " + name_of(key) + " " + problem);
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

void check_report(const ReportedContact& report,
                  std::span<const BodyPlace> places,
                  std::size_t material_count) {
  check_bodies(report.key, places);
  check_material(report.key, place_of(places, report.key.body_a), report.material_a);
  check_material(report.key, place_of(places, report.key.body_b), report.material_b);
  if (!(std::abs(vector_of(report.normal).norm() - 1) <= 1e-6)) {
    refuse(report.key, "has a normal that is not a unit vector");
  }
  if (!(report.area >= 0) || !std::isfinite(report.area)) {
    refuse(report.key,
           "has area " + std::to_string(report.area) + ", expected a finite number of 0 or more");
  }
  if (report.material < 0 || static_cast<std::size_t>(report.material) >= material_count) {
    refuse(report.key, "has material " + std::to_string(report.material) + ", there are " +
                           std::to_string(material_count) + " materials");
  }
  if (!are_finite({report.point_a_world, report.point_b_world, report.tangent})) {
    refuse(report.key, "has a position or tangent that is not finite");
  }
  if (!are_finite({report.surface_velocity, report.obstacle_velocity}) ||
      !std::isfinite(report.approach_speed)) {
    refuse(report.key, "has a velocity that is not finite");
  }
  if (!(report.bonded_share > 0 && report.bonded_share <= 1)) {
    refuse(report.key, "has a bonded share that is not above 0 and at most 1");
  }
}

void check_records(const std::vector<ContactRecord>& records, std::size_t material_count) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    const ContactRecord& record = records[k];
    if (k > 0 && !(records[k - 1].key < record.key)) {
      refuse(record.key, "is out of order, sort the records by key");
    }
    const ContactKey& key = record.key;
    const bool is_ordered =
        key.body_a < key.body_b || (key.body_a == key.body_b && key.feature_a < key.feature_b &&
                                    !record.material_a.is_rigid());
    if (!is_ordered) refuse(key, "must name the body with the smaller index first");
    if (!(record.intensity >= 0 && record.intensity <= 1) || record.material < 0 ||
        static_cast<std::size_t>(record.material) >= material_count) {
      refuse(record.key, "has an intensity outside [0, 1] or a material index out of range");
    }
    if (!(record.area >= 0) || !std::isfinite(record.area) ||
        !are_finite({record.anchor_a, record.anchor_b, record.normal_a, record.normal_b,
                     record.impulse_world, record.material_a.weight, record.material_b.weight,
                     record.normal_world}) ||
        !std::isfinite(record.standoff)) {
      refuse(record.key, "has a negative area or a number that is not finite");
    }
  }
}

void check_record_bodies(const ContactRecord& record, std::span<const BodyPlace> places) {
  check_bodies(record.key, places);
  check_material(record.key, place_of(places, record.key.body_a), record.material_a);
  check_material(record.key, place_of(places, record.key.body_b), record.material_b);
}

void check_places(std::span<const BodyPlace> places, int threads) {
  constexpr std::size_t vertices_per_thread = 16384;
  std::size_t vertices = 0;
  for (const BodyPlace& place : places) vertices += place.vertices.size();
  if (vertices < 2 * vertices_per_thread) threads = 1;
  parallel_tasks(threads, std::ssize(places), [&](std::int64_t b) {
    check_place(static_cast<std::size_t>(b), places[static_cast<std::size_t>(b)]);
  });
}

void check_solution(const ContactSolution& solution,
                    const std::vector<TrackedContact>& contacts,
                    std::span<const double> pressing) {
  const auto check = [&](const std::string& name, std::span<const double> values,
                         std::size_t count) {
    if (values.size() != count * contacts.size()) {
      refuse(name, "has " + std::to_string(values.size()) + " numbers, expected " +
                       std::to_string(count) + " for each of " + std::to_string(contacts.size()) +
                       " contacts");
    }
    for (std::size_t n = 0; n < values.size(); ++n) {
      if (std::isfinite(values[n])) continue;
      const ContactKey& key = contacts[n / count].key;
      throw ContactKeyError(key, "ContactTracker: " + name + " of " + name_of(key) + " is " +
                                     text_of(values[n]) +
                                     ", expected a finite number; do not pass on a solve that "
                                     "failed");
    }
  };
  check("solution.impulse", solution.impulse, 3);
  check("solution.velocity", solution.velocity, 3);
  if (!pressing.empty()) check("pressing", pressing, 1);
}

}  // namespace tetwarp

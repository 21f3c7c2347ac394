#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/contact_tracker.hpp>
#include <utility>

#include "host/contact/tracker/geometry.hpp"
#include "host/contact/tracker/match.hpp"

namespace tetwarp {
namespace {
using Eigen::Vector3d;

[[noreturn]] void refuse(const std::string& subject, const std::string& problem) {
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
          material.initial_intensity, 1 - material.initial_intensity}) {
      if (std::isfinite(value) && value >= 0) continue;
      refuse("material " + std::to_string(m),
             "has a constant that is negative or not finite, or an intensity above 1");
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
  const Vector3d sum =
      vector_of(report.point_a_world) + vector_of(report.point_b_world) + vector_of(report.tangent);
  if (!sum.allFinite()) refuse(name_of(report.key), "has a position that is not finite");
}

/// The reports in key order, sorted by key.
/// @throws std::invalid_argument  two have the same key
std::vector<ReportedContact> sorted(std::span<const ReportedContact> reports) {
  std::vector<ReportedContact> result;
  result.reserve(reports.size());
  for (const ReportedContact& report : reports) result.push_back(in_key_order(report));
  std::sort(result.begin(), result.end(),
            [](const auto& a, const auto& b) { return a.key < b.key; });
  for (std::size_t r = 1; r < result.size(); ++r) {
    if (result[r].key == result[r - 1].key) refuse(name_of(result[r].key), "is reported twice");
  }
  return result;
}

/// Updates a record, or a new one, from its report.
void update(ContactRecord& record,
            const ReportedContact& report,
            std::span<const BodyPose> poses,
            const ContactTrackerOptions& options) {
  const BodyPose& pose_a = poses[static_cast<std::size_t>(report.key.body_a)];
  const BodyPose& pose_b = poses[static_cast<std::size_t>(report.key.body_b)];
  const Vector3d normal = vector_of(report.normal).normalized();
  const Vector3d point_a = vector_of(report.point_a_world);
  const Vector3d point_b = vector_of(report.point_b_world);
  record.key = report.key;
  record.material = report.material;
  record.area = report.area;
  record.normal_a = point_of(rotation_of(pose_a).conjugate() * normal);
  record.normal_b = point_of(rotation_of(pose_b).conjugate() * normal);
  if (record.intensity > 0) return;
  record.anchor_a = body_of(pose_a, point_a);
  record.anchor_b = body_of(pose_b, point_b);
  if (!record.has_touched && normal.dot(point_a - point_b) <= options.touch_distance) {
    record.has_touched = true;
    record.intensity =
        options.materials[static_cast<std::size_t>(record.material)].initial_intensity;
  }
}

/// The contact of a record at its reported points or, without a report, at its anchors.
/// @param report  or null
TrackedContact contact_of(const ContactRecord& record,
                          const ReportedContact* report,
                          std::span<const BodyPose> poses) {
  const BodyPose& pose_a = poses[static_cast<std::size_t>(record.key.body_a)];
  const BodyPose& pose_b = poses[static_cast<std::size_t>(record.key.body_b)];
  const Vector3d anchor_a = world_of(pose_a, record.anchor_a);
  const Vector3d anchor_b = world_of(pose_b, record.anchor_b);
  const Vector3d point_a = report != nullptr ? vector_of(report->point_a_world) : anchor_a;
  const Vector3d point_b = report != nullptr ? vector_of(report->point_b_world) : anchor_b;
  const Vector3d normal = report != nullptr ? vector_of(report->normal).normalized()
                                            : carried_normal(record, pose_a, pose_b);
  const Vector3d tangent =
      tangent_of(normal, report != nullptr ? vector_of(report->tangent) : Vector3d::Zero());
  const Vector3d other = normal.cross(tangent);
  // Without adhesion the anchors are the reported points, and there are no tangential gaps.
  const Vector3d apart = record.intensity > 0 ? Vector3d(anchor_a - anchor_b) : Vector3d::Zero();
  TrackedContact contact;
  contact.key = record.key;
  contact.point_a_world = point_of(point_a);
  contact.point_b_world = point_of(point_b);
  contact.axes = {point_of(normal), point_of(tangent), point_of(other)};
  contact.gap = {normal.dot(point_a - point_b), tangent.dot(apart), other.dot(apart)};
  contact.is_reported = report != nullptr;
  return contact;
}

/// Moves anchor b so that the tangential gap is multiplied by `keep`.
void shrink_gap(ContactRecord& record, double keep, std::span<const BodyPose> poses) {
  const BodyPose& pose_a = poses[static_cast<std::size_t>(record.key.body_a)];
  const BodyPose& pose_b = poses[static_cast<std::size_t>(record.key.body_b)];
  const Vector3d normal = carried_normal(record, pose_a, pose_b);
  const Vector3d anchor_b = world_of(pose_b, record.anchor_b);
  const Vector3d apart = world_of(pose_a, record.anchor_a) - anchor_b;
  const Vector3d sideways = apart - normal.dot(apart) * normal;
  record.anchor_b = body_of(pose_b, anchor_b + (1 - keep) * sideways);
}
}  // namespace

ContactTracker::ContactTracker(ContactTrackerOptions options, std::vector<ContactRecord> records)
    : options_(std::move(options)), records_(std::move(records)) {
  check_materials(options_.materials);
  if (!(options_.match_distance >= 0) || !(options_.touch_distance >= 0)) {
    refuse("match_distance and touch_distance", "must not be negative");
  }
  for (std::size_t k = 0; k < records_.size(); ++k) {
    const ContactRecord& record = records_[k];
    if (k > 0 && !(records_[k - 1].key < record.key)) {
      refuse(name_of(record.key), "is out of order, sort the records by key");
    }
    if (!(record.key.body_a < record.key.body_b)) {
      refuse(name_of(record.key), "must name the body with the smaller index first");
    }
    if (!(record.intensity >= 0 && record.intensity <= 1) || record.material < 0 ||
        static_cast<std::size_t>(record.material) >= options_.materials.size()) {
      refuse(name_of(record.key),
             "has an intensity outside [0, 1] or a material index out of range");
    }
  }
}

const std::vector<TrackedContact>& ContactTracker::begin_step(
    std::span<const ReportedContact> unsorted, std::span<const BodyPose> poses, double time_step) {
  if (!(time_step > 0)) refuse("time_step", "must be more than 0 s");
  const std::vector<ReportedContact> reports = sorted(unsorted);
  for (const ReportedContact& report : reports) {
    check_report(report, poses.size(), options_.materials.size());
  }
  for (const ContactRecord& record : records_) check_bodies(record.key, poses.size());
  const std::vector<std::int64_t> matches =
      match_contacts(reports, records_, poses, options_.match_distance);

  struct Step {
    ContactRecord record;
    const ReportedContact* report;
  };
  std::vector<Step> steps;
  std::vector<bool> is_matched(records_.size());
  for (std::size_t r = 0; r < reports.size(); ++r) {
    Step step{{}, &reports[r]};
    if (matches[r] >= 0) {
      step.record = records_[static_cast<std::size_t>(matches[r])];
      is_matched[static_cast<std::size_t>(matches[r])] = true;
    }
    update(step.record, reports[r], poses, options_);
    steps.push_back(step);
  }
  for (std::size_t k = 0; k < records_.size(); ++k) {
    if (!is_matched[k] && records_[k].intensity > 0) steps.push_back({records_[k], nullptr});
  }
  std::sort(steps.begin(), steps.end(),
            [](const Step& a, const Step& b) { return a.record.key < b.record.key; });

  time_step_ = time_step;
  records_.clear();
  contacts_.clear();
  for (const Step& step : steps) {
    records_.push_back(step.record);
    contacts_.push_back(contact_of(step.record, step.report, poses));
  }
  return contacts_;
}

void ContactTracker::fill(ContactProblem& problem) const {
  problem.friction.clear();
  problem.velocity_offset.clear();
  problem.impulse_guess.clear();
  AdhesionState& adhesion = problem.adhesion;
  adhesion = {};
  adhesion.time_step = time_step_;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const ContactRecord& record = records_[c];
    const TrackedContact& contact = contacts_[c];
    const ContactMaterial& material = options_.materials[static_cast<std::size_t>(record.material)];
    problem.friction.push_back(material.friction);
    problem.velocity_offset.insert(problem.velocity_offset.end(),
                                   {contact.gap[0] / time_step_, 0, 0});
    adhesion.area.push_back(record.area);
    adhesion.stiffness.push_back(material.stiffness);
    adhesion.tangential_stiffness.push_back(
        material.tangential_stiffness.value_or(material.stiffness));
    adhesion.intensity.push_back(record.intensity);
    adhesion.energy.push_back(material.energy);
    adhesion.viscosity.push_back(material.viscosity);
    adhesion.bonding_rate.push_back(material.bonding_rate);
    adhesion.saturation_pressure.push_back(material.saturation_pressure);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      adhesion.gap.push_back(contact.gap[axis]);
      problem.impulse_guess.push_back(
          vector_of(contact.axes[axis]).dot(vector_of(record.impulse_world)));
    }
  }
}

AdhesionStep ContactTracker::end_step(const ContactSolution& solution,
                                      std::span<const BodyPose> poses) {
  for (const ContactRecord& record : records_) check_bodies(record.key, poses.size());
  ContactProblem problem;
  fill(problem);
  AdhesionStep step = evolve_adhesion(problem, solution, options_.evolution);
  std::vector<ContactRecord> kept;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    ContactRecord record = records_[c];
    const double before = record.intensity;
    record.intensity = step.intensity[c];
    if (!record.has_touched && solution.impulse[3 * c] > 0) {
      record.has_touched = true;
      const auto material = static_cast<std::size_t>(record.material);
      record.intensity = std::max(record.intensity, options_.materials[material].initial_intensity);
    }
    if (record.intensity > before) {
      const double ratio = before / record.intensity;
      shrink_gap(record, ratio * ratio, poses);
    }
    Vector3d impulse = Vector3d::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      impulse += solution.impulse[3 * c + axis] * vector_of(contacts_[c].axes[axis]);
    }
    record.impulse_world = point_of(impulse);
    if (contacts_[c].is_reported || record.intensity > 0) kept.push_back(record);
  }
  records_ = std::move(kept);
  contacts_.clear();
  return step;
}

}  // namespace tetwarp

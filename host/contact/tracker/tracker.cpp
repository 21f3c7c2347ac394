#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/contact_tracker.hpp>
#include <utility>

#include "host/contact/tracker/geometry.hpp"
#include "host/contact/tracker/input_checks.hpp"
#include "host/contact/tracker/match.hpp"

namespace tetwarp {
namespace {
using Eigen::Vector3d;

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

/// Sets what the report prescribes; a contact that is not reported keeps zeros.
/// @param report  or null
void set_velocities(TrackedContact& contact,
                    const ReportedContact* report,
                    const ContactTrackerOptions& options,
                    double time_step) {
  if (report == nullptr) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d axis = vector_of(contact.axes[k]);
    contact.surface_velocity[k] = axis.dot(vector_of(report->surface_velocity));
    contact.obstacle_velocity[k] = axis.dot(vector_of(report->obstacle_velocity));
  }
  const double approach = report->approach_speed;
  const bool is_impact =
      approach > options.restitution_speed && contact.gap[0] <= time_step * approach;
  if (!is_impact) return;
  contact.rebound_speed =
      options.materials[static_cast<std::size_t>(report->material)].restitution * approach;
}

/// The velocity of a relative to b that is not in the bodies' velocities, along the axes.
Point3 prescribed_velocity(const TrackedContact& contact) {
  return point_of(vector_of(contact.surface_velocity) + vector_of(contact.obstacle_velocity));
}

/// Moves anchor b with the surfaces, whose motion the poses do not show.
void carry_anchor(ContactRecord& record,
                  const TrackedContact& contact,
                  double time_step,
                  std::span<const BodyPose> poses) {
  if (contact.surface_velocity == Point3{0, 0, 0}) return;
  const BodyPose& pose_b = poses[static_cast<std::size_t>(record.key.body_b)];
  Vector3d anchor_b = world_of(pose_b, record.anchor_b);
  for (std::size_t k = 0; k < 3; ++k) {
    anchor_b -= time_step * contact.surface_velocity[k] * vector_of(contact.axes[k]);
  }
  record.anchor_b = body_of(pose_b, anchor_b);
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
  if (!(options_.restitution_speed >= 0)) refuse("restitution_speed", "must not be negative");
  check_records(records_, options_.materials.size());
}

const std::vector<TrackedContact>& ContactTracker::begin_step(
    std::span<const ReportedContact> unsorted, std::span<const BodyPose> poses, double time_step) {
  if (!(time_step > 0) || !std::isfinite(time_step)) {
    refuse("time_step", "must be a finite time of more than 0 s");
  }
  check_poses(poses);
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

  std::vector<ContactRecord> records;
  std::vector<TrackedContact> contacts;
  for (const Step& step : steps) {
    records.push_back(step.record);
    contacts.push_back(contact_of(step.record, step.report, poses));
    set_velocities(contacts.back(), step.report, options_, time_step);
  }
  time_step_ = time_step;
  is_in_step_ = true;
  records_ = std::move(records);
  contacts_ = std::move(contacts);
  return contacts_;
}

void ContactTracker::fill(ContactProblem& problem) const {
  if (!is_in_step_) {
    throw std::logic_error("ContactTracker: fill() outside of a step, call begin_step() first");
  }
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
    const Point3 moving = prescribed_velocity(contact);
    const double closing = contact.gap[0] / time_step_;
    const double normal =
        contact.rebound_speed > 0 ? std::min(closing, -contact.rebound_speed) : closing;
    problem.velocity_offset.insert(problem.velocity_offset.end(),
                                   {normal + moving[0], moving[1], moving[2]});
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
      // Springs see the normal gap that the prescribed motion leaves; see AdhesionState::gap.
      adhesion.gap.push_back(contact.gap[axis] + (axis == 0 ? time_step_ * moving[0] : 0));
      problem.impulse_guess.push_back(
          vector_of(contact.axes[axis]).dot(vector_of(record.impulse_world)));
    }
  }
}

AdhesionStep ContactTracker::end_step(const ContactSolution& solution,
                                      std::span<const BodyPose> poses) {
  if (!is_in_step_) {
    throw std::logic_error(
        "ContactTracker: end_step() without a step, call begin_step() before each end_step()");
  }
  check_poses(poses);
  for (const ContactRecord& record : records_) check_bodies(record.key, poses.size());
  check_solution(solution, contacts_);
  ContactProblem problem;
  fill(problem);
  AdhesionStep step = evolve_adhesion(problem, solution, options_.evolution);
  std::vector<ContactRecord> kept;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    ContactRecord record = records_[c];
    const double before = record.intensity;
    record.intensity = step.intensity[c];
    carry_anchor(record, contacts_[c], time_step_, poses);
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
    if (!impulse.allFinite() || !std::isfinite(step.intensity[c])) {
      refuse(name_of(record.key), "has an impulse or a velocity beyond the range of numbers");
    }
    record.impulse_world = point_of(impulse);
    if (contacts_[c].is_reported || record.intensity > 0) kept.push_back(record);
  }
  records_ = std::move(kept);
  is_in_step_ = false;
  return step;
}

}  // namespace tetwarp

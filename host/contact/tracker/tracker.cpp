/// @file tracker.cpp
/// ContactTracker: records of contacts from step to step.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/contact_tracker.hpp>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/contact/problem/pressed_adhesion.hpp"
#include "host/contact/tracker/geometry.hpp"
#include "host/contact/tracker/input_checks.hpp"
#include "host/contact/tracker/match.hpp"
#include "host/contact/tracker/record_update.hpp"

namespace tetwarp {
namespace {
using Eigen::Vector3d;

/// op(i) for i in [0, count).
template <class Op>
void for_contacts(int threads, std::size_t count, const Op& op) {
  const auto size = static_cast<std::int64_t>(count);
  parallel_for(threads_for(threads, size), size,
               [&](std::int64_t i) { op(static_cast<std::size_t>(i)); });
}

/// What a contact of a step continues: at least one of both is not null.
struct Source {
  const ContactRecord* record;
  const ReportedContact* report;
};

/// The sources of the contacts of a step, in the order of keys: of all reports, and of records with
/// adhesion that no report matches.
std::vector<Source> sources_of(std::span<const ReportedContact> reports,
                               std::span<const ContactRecord> records,
                               std::span<const std::int64_t> matches) {
  std::vector<std::uint8_t> is_matched(records.size());
  for (const std::int64_t match : matches) {
    if (match >= 0) is_matched[static_cast<std::size_t>(match)] = 1;
  }
  std::vector<Source> sources;
  sources.reserve(reports.size() + records.size());
  std::size_t k = 0;
  const auto add_kept = [&](const ContactKey* up_to) {
    for (; k < records.size() && (up_to == nullptr || records[k].key < *up_to); ++k) {
      if (is_matched[k] == 0 && records[k].intensity > 0) sources.push_back({&records[k], nullptr});
    }
  };
  for (std::size_t r = 0; r < reports.size(); ++r) {
    add_kept(&reports[r].key);
    const std::int64_t match = matches[r];
    sources.push_back(
        {match >= 0 ? &records[static_cast<std::size_t>(match)] : nullptr, &reports[r]});
  }
  add_kept(nullptr);
  return sources;
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

/// Moves anchor b with the surfaces, whose motion the places do not show.
void carry_anchor(ContactRecord& record,
                  const TrackedContact& contact,
                  double time_step,
                  std::span<const BodyPlace> places) {
  if (contact.surface_velocity == Point3{0, 0, 0}) return;
  Vector3d way = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    way -= time_step * contact.surface_velocity[k] * vector_of(contact.axes[k]);
  }
  move_anchor(record, way, vector_of(contact.axes[0]), places);
}

std::vector<BodyPlace> places_of(std::span<const BodyPose> poses) {
  std::vector<BodyPlace> places(poses.size());
  for (std::size_t b = 0; b < poses.size(); ++b) places[b].pose = poses[b];
  return places;
}
}  // namespace

ContactTracker::ContactTracker(ContactTrackerOptions options, std::vector<ContactRecord> records)
    : options_(std::move(options)), records_(std::move(records)) {
  check_materials(options_.materials);
  if (!(options_.match_distance >= 0) || !(options_.touch_distance >= 0)) {
    refuse("match_distance and touch_distance", "must not be negative");
  }
  if (!(options_.restitution_speed >= 0)) refuse("restitution_speed", "must not be negative");
  options_.threads = thread_count(options_.threads);
  check_records(records_, options_.materials.size());
}

const std::vector<TrackedContact>& ContactTracker::begin_step(
    std::span<const ReportedContact> unsorted,
    std::span<const BodyPlace> places,
    double time_step) {
  if (!(time_step > 0) || !std::isfinite(time_step)) {
    refuse("time_step", "must be a finite time of more than 0 s");
  }
  check_places(places, options_.threads);
  std::vector<ReportedContact> storage;
  const std::span<const ReportedContact> reports = sorted_reports(unsorted, storage);
  for_contacts(options_.threads, reports.size(),
               [&](std::size_t r) { check_report(reports[r], places, options_.materials.size()); });
  const std::vector<ContactRecord>& before = start_records();
  for_contacts(options_.threads, before.size(),
               [&](std::size_t k) { check_record_bodies(before[k], places); });
  const std::vector<std::int64_t> matches =
      match_contacts(reports, before, places, options_.match_distance);
  const std::vector<Source> sources = sources_of(reports, before, matches);
  next_records_.resize(sources.size());
  next_contacts_.resize(sources.size());
  for_contacts(options_.threads, sources.size(), [&](std::size_t c) {
    const auto [from, report] = sources[c];
    ContactRecord& record = next_records_[c];
    record = from != nullptr ? *from : ContactRecord{};
    if (report != nullptr) update_record(record, *report, places, options_);
    TrackedContact& contact = next_contacts_[c];
    contact = contact_of(record, report, places);
    record.normal_world = contact.axes[0];
    set_velocities(contact, report, options_, time_step);
  });
  time_step_ = time_step;
  if (!is_in_step_) start_records_.swap(records_);
  is_in_step_ = true;
  records_.swap(next_records_);
  contacts_.swap(next_contacts_);
  return contacts_;
}

const std::vector<TrackedContact>& ContactTracker::begin_step(
    std::span<const ReportedContact> reports, std::span<const BodyPose> poses, double time_step) {
  return begin_step(reports, std::span<const BodyPlace>(places_of(poses)), time_step);
}

void ContactTracker::fill(ContactProblem& problem) const {
  if (!is_in_step_) {
    throw std::logic_error("ContactTracker: fill() outside of a step, call begin_step() first");
  }
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = time_step_;
  const std::size_t count = contacts_.size();
  for (std::vector<double>* const values :
       {&problem.friction, &adhesion.area, &adhesion.stiffness, &adhesion.tangential_stiffness,
        &adhesion.intensity, &adhesion.energy, &adhesion.viscosity, &adhesion.bonding_rate,
        &adhesion.saturation_pressure}) {
    values->resize(count);
  }
  for (std::vector<double>* const vectors :
       {&problem.velocity_offset, &problem.impulse_guess, &adhesion.gap}) {
    vectors->resize(3 * count);
  }
  for_contacts(options_.threads, count, [&](std::size_t c) {
    const ContactRecord& record = records_[c];
    const TrackedContact& contact = contacts_[c];
    const ContactMaterial& material = options_.materials[static_cast<std::size_t>(record.material)];
    problem.friction[c] = material.friction;
    adhesion.area[c] = record.area;
    adhesion.stiffness[c] = material.stiffness;
    adhesion.tangential_stiffness[c] = material.tangential_stiffness.value_or(material.stiffness);
    adhesion.intensity[c] = record.intensity;
    adhesion.energy[c] = material.energy;
    adhesion.viscosity[c] = material.viscosity;
    adhesion.bonding_rate[c] = material.bonding_rate;
    adhesion.saturation_pressure[c] = material.saturation_pressure;
    const Point3 moving = prescribed_velocity(contact);
    const double closing = contact.gap[0] / time_step_;
    const double normal =
        contact.rebound_speed > 0 ? std::min(closing, -contact.rebound_speed) : closing;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      problem.velocity_offset[3 * c + axis] = axis == 0 ? normal + moving[0] : moving[axis];
      // Springs see the normal gap that the prescribed motion leaves; see AdhesionState::gap.
      adhesion.gap[3 * c + axis] = contact.gap[axis] + (axis == 0 ? time_step_ * moving[0] : 0);
      problem.impulse_guess[3 * c + axis] =
          vector_of(contact.axes[axis]).dot(vector_of(record.impulse_world));
    }
  });
}

AdhesionStep ContactTracker::end_step(const ContactSolution& solution,
                                      std::span<const BodyPose> poses) {
  return end_step(solution, std::span<const BodyPlace>(places_of(poses)));
}

AdhesionStep ContactTracker::end_step(const ContactSolution& solution,
                                      std::span<const BodyPlace> places,
                                      std::span<const double> pressing) {
  if (!is_in_step_) {
    throw std::logic_error(
        "ContactTracker: end_step() without a step, call begin_step() before each end_step()");
  }
  check_places(places, options_.threads);
  for_contacts(options_.threads, records_.size(),
               [&](std::size_t c) { check_record_bodies(records_[c], places); });
  check_solution(solution, contacts_, pressing);
  fill(problem_);
  AdhesionStep step = evolve_adhesion(problem_, solution, options_.evolution, nullptr, pressing);
  next_records_.resize(records_.size());
  for_contacts(options_.threads, records_.size(), [&](std::size_t c) {
    ContactRecord& record = next_records_[c];
    record = records_[c];
    const double before = record.intensity;
    record.intensity = record.area > 0 ? step.intensity[c] : 0;
    carry_anchor(record, contacts_[c], time_step_, places);
    const bool is_pressed = solution.impulse[3 * c] > 0 || (!pressing.empty() && pressing[c] > 0);
    if (!record.has_touched && record.area > 0 && is_pressed) {
      record.has_touched = true;
      const auto material = static_cast<std::size_t>(record.material);
      record.intensity = std::max(record.intensity, options_.materials[material].initial_intensity);
    }
    if (record.intensity > before) {
      const double ratio = before / record.intensity;
      shrink_gap(record, ratio * ratio, places);
    }
    Vector3d impulse = Vector3d::Zero();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      impulse += solution.impulse[3 * c + axis] * vector_of(contacts_[c].axes[axis]);
    }
    if (!impulse.allFinite() || !std::isfinite(step.intensity[c])) {
      refuse(record.key, "has an impulse or a velocity beyond the range of numbers");
    }
    record.impulse_world = point_of(impulse);
  });
  std::size_t kept = 0;
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (!contacts_[c].is_reported && !(next_records_[c].intensity > 0)) continue;
    if (kept != c) next_records_[kept] = next_records_[c];
    ++kept;
  }
  next_records_.resize(kept);
  records_.swap(next_records_);
  start_records_.clear();
  is_in_step_ = false;
  return step;
}

}  // namespace tetwarp

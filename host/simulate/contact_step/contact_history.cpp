/// @file contact_history.cpp
/// Records of contacts, velocity changes, and memory of earlier parts of a step.
#include "host/simulate/contact_step/contact_history.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

/// Every material twice: the second ones without initial adhesion.
ContactTrackerOptions tracker_options(const SceneSurfaces& surfaces, int threads) {
  ContactTrackerOptions of;
  of.materials = surfaces.materials;
  of.materials.insert(of.materials.end(), surfaces.materials.begin(), surfaces.materials.end());
  for (std::size_t m = surfaces.materials.size(); m < of.materials.size(); ++m) {
    of.materials[m].initial_intensity = 0;
  }
  of.match_distance = surfaces.surfaces.thickness;
  of.touch_distance = surfaces.surfaces.thickness;
  of.threads = threads;
  return of;
}

}  // namespace

ContactHistory::ContactHistory(const SceneSurfaces& surfaces, int threads)
    : options_(tracker_options(surfaces, threads)),
      tracker_(options_),
      pressing_(surfaces, options_.materials) {}

void ContactHistory::set_time_step(double time_step) {
  if (time_step_ > 0 && time_step_ != time_step) {
    const double ratio = time_step / time_step_;
    for (Point3& change : change_) change = times(ratio, change);
    std::vector<ContactRecord> records = tracker_.records();
    for (ContactRecord& record : records) {
      record.impulse_world = times(ratio, record.impulse_world);
    }
    set_records(std::move(records));
  }
  time_step_ = time_step;
}

void ContactHistory::begin_part() {
  contacts_ = nullptr;
}

const std::vector<TrackedContact>& ContactHistory::track(std::vector<ReportedContact>& reports,
                                                         const std::vector<BodyPlace>& bodies,
                                                         bool has_initial_bonds) {
  const auto without_bonds = static_cast<std::int32_t>(options_.materials.size() / 2);
  for (ReportedContact& report : reports) {
    const double gap = dot(report.normal, minus(report.point_a_world, report.point_b_world));
    if (!has_initial_bonds || gap > options_.touch_distance) report.material += without_bonds;
  }
  contacts_ = &tracker_.begin_step(reports, bodies, time_step_);
  return *contacts_;
}

AdhesionStep ContactHistory::end_part(const ContactSolution& solution,
                                      const std::vector<BodyPlace>& bodies) {
  return tracker_.end_step(solution, bodies,
                           pressing_.spread(*contacts_, tracker_.records(), solution.impulse));
}

void ContactHistory::set_records(std::vector<ContactRecord> records) {
  tracker_ = ContactTracker(options_, std::move(records));
  contacts_ = nullptr;
}

void ContactHistory::add_records(const std::vector<ContactRecord>& records) {
  const std::vector<ContactRecord>& own = tracker_.start_records();
  std::vector<ContactRecord> all;
  std::merge(own.begin(), own.end(), records.begin(), records.end(), std::back_inserter(all),
             [](const ContactRecord& a, const ContactRecord& b) { return a.key < b.key; });
  set_records(std::move(all));
}

void ContactHistory::restore(double time_step,
                             const std::vector<ContactRecord>& records,
                             const std::vector<Point3>& change) {
  set_records(records);
  time_step_ = time_step;
  change_ = change;
}

}  // namespace tetwarp

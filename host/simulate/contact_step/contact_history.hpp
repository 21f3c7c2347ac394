/// @file contact_history.hpp
/// ContactHistory: what contacts keep from one part of a step to the next.
#pragma once
#include <vector>

#include <tetwarp/contact_tracker.hpp>

#include "host/simulate/contact_step/pressing_impulses.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Records of contacts, and by how much contacts changed the velocities.
class ContactHistory {
 public:
  ContactHistory(const SceneSurfaces& surfaces, int threads);

  /// Impulses and changes of another step are a guess for those of a step of `time_step` seconds,
  /// in proportion to its time.
  void set_time_step(double time_step);
  double time_step() const { return time_step_; }
  /// Starts a part without contacts.
  void begin_part();
  /// Tracks the contacts of a part, and gives their materials to the reports. May be repeated with
  /// a longer list.
  /// @param has_initial_bonds  whether surfaces that are near have their initial adhesion
  const std::vector<TrackedContact>& track(std::vector<ReportedContact>& reports,
                                           const std::vector<BodyPlace>& bodies,
                                           bool has_initial_bonds);
  /// Ends the part that track() began.
  /// @param solution  of the contacts that track() returned
  /// @param bodies  at its end
  AdhesionStep end_part(const ContactSolution& solution, const std::vector<BodyPlace>& bodies);

  const ContactTracker& tracker() const { return tracker_; }
  const ContactTrackerOptions& options() const { return options_; }
  /// What the last track() of the part returned; null: there was none.
  const std::vector<TrackedContact>* contacts() const { return contacts_; }

  /// Changes of velocities by contacts in the last part, [block_count], or empty.
  std::vector<Point3>& change() { return change_; }
  const std::vector<Point3>& change() const { return change_; }

  /// Goes on from other records, between parts.
  /// @param records  sorted by key
  void set_records(std::vector<ContactRecord> records);
  /// The same, from those at the start of the part and others.
  /// @param records  sorted by key
  void add_records(const std::vector<ContactRecord>& records);

  /// Goes on from another step; see ContactMemory.
  void restore(double time_step,
               const std::vector<ContactRecord>& records,
               const std::vector<Point3>& change);

 private:
  ContactTrackerOptions options_;
  ContactTracker tracker_;
  PressingImpulses pressing_;
  const std::vector<TrackedContact>* contacts_ = nullptr;
  std::vector<Point3> change_;
  double time_step_ = 0;  ///< of the impulses of records and of change_ [s]
};

}  // namespace tetwarp

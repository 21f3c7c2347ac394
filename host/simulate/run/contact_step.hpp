/// @file contact_step.hpp
/// ContactStep: the part of a time step that keeps bodies apart.
///
/// Detection along the expected motion, contacts, their solution, detection along the motion that
/// results, until nothing new is hit; then a check that no pair comes too near, which shortens the
/// ways of those that do. A scene that starts apart never intersects.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <tetwarp/contact_tracker.hpp>
#include <tetwarp/simulate.hpp>

#include "host/collide/detector.hpp"

#include "host/simulate/patches/pair_contacts.hpp"
#include "host/simulate/run/contact_memory.hpp"
#include "host/simulate/run/island_sleep.hpp"
#include "host/simulate/run/step_groups.hpp"
#include "host/simulate/solve/contact_system.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "host/simulate/step/stepper.hpp"
#include "host/simulate/surfaces/kept_places.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

struct ContactStepOptions {
  Backend backend = Backend::cpu;
  int threads = 1;
  int device = 0;
  SimulateSkipOptions skip = {};
  bool sleeps = false;                        ///< bodies may sleep
  std::shared_ptr<RestFactors> factors = {};  ///< of elastic bodies, or null: own ones
  std::function<bool()> progress = {};        ///< false ends the step
};

/// What contact did in a step or a part of one.
struct ContactPart {
  bool is_completed = true;         ///< false: `progress` ended it
  std::vector<std::int32_t> woken;  ///< bodies that sleep and are reached by something that moves;
                                    ///< then nothing has moved
  bool converged = true;
  double residual = 0;  ///< eta, the largest
  std::int64_t contacts = 0, islands = 0;
  std::int64_t passes = 0, sweeps = 0, outer_iterations = 0;
  std::int64_t clamped_islands = 0, stalled_scripts = 0;
  double smallest_fraction = 1;  ///< of the step that an island moved
  double detection_seconds = 0, contact_seconds = 0;
};
/// Adds counts and seconds of a later part; contacts and islands are those of the last part.
void add_part(const ContactPart& part, ContactPart& sum);

class ContactStep {
 public:
  /// @param scene, model, surfaces  kept by the caller
  ContactStep(const Scene& scene,
              const Model& model,
              const SceneSurfaces& surfaces,
              const ContactStepOptions& options);

  ContactStep(const ContactStep&) = delete;
  ContactStep& operator=(const ContactStep&) = delete;

  /// Whether any two surfaces of a scene may ever touch.
  static bool can_touch(const CollisionSurfaces& surfaces);

  /// For the start of a simulation.
  Detector& detector() { return *detector_; }

  /// Velocities from which BodyStepper::solve() should start, [block_count] [m/s, rad/s]: those
  /// without contact of the step before. Empty: those of the state.
  /// @param start      state at the start of the part
  /// @param time_step  of the part [s]
  std::vector<Point3> guess(const ModelState& start, double time_step);

  /// After BodyStepper::solve(): replaces the velocities by those with contact and moves the
  /// bodies.
  /// @param start     state at the start of the part
  /// @param is_first  whether it is the first part of a simulation, in which surfaces that are near
  ///                  have their initial adhesion
  ContactPart advance(const ModelState& start,
                      double time_step,
                      bool is_first,
                      BodyStepper& stepper,
                      StepSeconds& seconds);
  /// Ends a part that advance() has completed.
  /// @param after  state at its end
  void end(const ModelState& after, ContactPart& part);

  /// Of the last part: the fraction of it that each body and obstacle moved.
  const std::vector<double>& fractions() const { return groups_.fractions(); }
  /// Of the last part: impulses of contacts on blocks [block_count], and on bodies, then obstacles.
  const std::vector<Point3>& block_impulses() const { return block_impulses_; }
  const std::vector<Point3>& body_impulses() const { return body_impulses_; }
  /// Moves the contacts at the end of the last part to `points`, and what was there to here, as
  /// memory for later parts. Once per part.
  void take_points(std::vector<ContactPoint>& points) { points.swap(points_); }

  void remember(ContactMemory& memory) const {
    memory.time_step = time_step_;
    memory.records = tracker_.records();
    memory.change = change_;
    memory.sleeping = sleeping_;
  }
  void restore(const ContactMemory& memory);

  /// For the next parts: bodies and obstacles that do not move, [bodies, then obstacles] or empty.
  /// A sleeping body among them must be woken where ContactPart::woken names it.
  void set_still(std::span<const std::uint8_t> is_still);
  /// After bodies have woken or begun to move: their contacts are solved again. Includes
  /// set_still().
  void thaw(std::span<const std::uint8_t> is_still);
  /// After end(), where bodies have fallen asleep: contacts between bodies that stand still are
  /// kept as they are. Includes set_still().
  void freeze(std::span<const std::uint8_t> is_still);
  /// The bodies of the contacts that are kept.
  const std::vector<BodyLink>& sleeping_links() const { return sleeping_links_; }
  /// Of the last part, with `sleeps`.
  const ContactRest& rest() const { return rest_; }

  /// Fills the adhesion's energy and area, and the smallest distance, in a state: that of the
  /// stepper of advance().
  void record(const ModelState& state, StepRecord& record);

 private:
  void set_time_step(double time_step);
  bool has_change() const;
  void set_places(const ModelState& state,
                  const SurfacePlaces& of,
                  std::vector<BodyPlace>& places) const;
  void move_surfaces(std::span<const double> fraction, SurfaceMotion& motion);
  void move_vertices(std::span<const double> fraction, SurfaceMotion& motion) const;
  void report(bool is_first);
  bool solve(BodyStepper& stepper, ContactPart& part);
  void find_velocities(bool is_first, BodyStepper& stepper, ContactPart& part);
  void keep_apart(ContactPart& part);
  std::int64_t stalled_scripts() const;
  void sum_impulses();
  ContactPlace place_of(std::size_t body, const MaterialPoint& point) const;
  void set_points();
  bool both_still(const BodyLink& bodies) const;
  std::vector<ContactRecord> bonds() const;
  void add_sleeping(const ModelState& state, double time_step, ContactPart& part);
  void set_sleeping(std::vector<SleepingContact> contacts);
  void set_sleeping_forces(const ModelState& state);
  void merge_points();
  void note_rest(const std::vector<double>& before);

  const Scene& scene_;
  const Model& model_;
  const SceneSurfaces& surfaces_;
  ContactStepOptions options_;
  std::int32_t material_count_ = 0;
  bool was_ended_ = false;  ///< by progress
  std::unique_ptr<Detector> detector_;
  ContactTrackerOptions tracker_options_;
  PairContacts pair_contacts_;
  ContactTracker tracker_;
  ContactSystem system_;
  StepGroups groups_;

  // Of the running part; kept, so that steps do not allocate them.
  const ModelState* start_ = nullptr;
  double time_step_ = 0;
  std::vector<Point3> free_velocity_, velocity_;
  bool is_free_ = true;                   ///< velocity_ is what the stepper has
  ResidentSurfaces* resident_ = nullptr;  ///< of the stepper
  std::vector<Point3> change_;            ///< see ContactMemory
  KeptPlaces places_;
  std::vector<SurfaceMotion> motions_;  ///< of the detections
  SurfaceMotion clamped_;               ///< of the end check with fractions below 1
  SurfaceMotion* final_ = nullptr;      ///< the last of these; it alone has the start
  std::vector<BodyPlace> start_places_, end_places_;
  bool has_pairs_ = false;                                 ///< detection has found any
  const std::vector<TrackedContact>* contacts_ = nullptr;  ///< null: nothing touches
  std::vector<Point3> block_impulses_, body_impulses_;
  std::vector<ContactPoint> points_, own_points_;  ///< own_points_: without those that sleep

  std::vector<SleepingContact> sleeping_;                         ///< sorted by key
  std::vector<BodyLink> sleeping_links_;                          ///< their bodies
  std::vector<std::pair<std::int32_t, Point3>> sleeping_forces_;  ///< on prescribed blocks [N, N m]
  bool has_sleeping_forces_ = false;                              ///< of the present list
  std::vector<std::uint8_t> still_;                               ///< see set_still()
  ContactRest rest_;
};

}  // namespace tetwarp

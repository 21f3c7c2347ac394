/// @file contact_step.hpp
/// ContactStep: the part of a time step that keeps bodies apart. Start at advance() and end(),
/// which list what it does.
///
/// Detection along the expected motion, contacts, their solution, detection along the motion that
/// results, until nothing new is hit; then a check that no pair comes too near, which shortens the
/// motions of those that do. Surfaces that start apart never intersect.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/collide/detector.hpp"
#include "host/simulate/contact_step/contact_history.hpp"
#include "host/simulate/contact_step/contact_impulses.hpp"
#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/contact_step/contact_passes.hpp"
#include "host/simulate/contact_step/contact_points.hpp"
#include "host/simulate/contact_step/contact_rest.hpp"
#include "host/simulate/contact_step/contact_step_options.hpp"
#include "host/simulate/contact_step/end_check.hpp"
#include "host/simulate/contact_step/part_motion.hpp"
#include "host/simulate/contact_step/sleeping_contacts.hpp"

namespace tetwarp {

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
  /// without contact of the last step. Empty: those of the state.
  /// @param start      state at the start of the part
  /// @param time_step  of the part [s]
  std::vector<Point3> guess(const ModelState& start, double time_step);

  /// After BodyStepper::solve(): replaces the velocities by those with contact and moves the
  /// bodies, unless the part says that sleeping bodies have to wake first.
  /// @param start     state at the start of the part
  /// @param is_first  whether it is the first part of a simulation, in which surfaces that are near
  ///                  have their initial adhesion
  ContactPart advance(const ModelState& start,
                      double time_step,
                      bool is_first,
                      BodyStepper& stepper);
  /// Ends a part that advance() has completed.
  /// @param after  state at its end
  void end(const ModelState& after, ContactPart& part);

  /// Of the last part: the fraction of it that each body and obstacle moved.
  const std::vector<double>& fractions() const { return end_check_.fractions(); }
  /// Of the last part.
  const ContactImpulses& impulses() const { return impulses_; }
  /// Moves the contacts at the end of the last part to `points`, and what was there to here, as
  /// memory for later parts. Once per part.
  void take_points(std::vector<ContactPoint>& points) { points_.swap(points); }

  ContactMemory memory() const;
  /// @throws std::invalid_argument  a record is out of range; then nothing has changed
  void set_memory(const ContactMemory& memory);

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
  const std::vector<BodyLink>& sleeping_links() const { return sleeping_.links(); }
  /// Of the last part, with `sleeps`.
  const ContactRest& rest() const { return rest_; }

  /// Fills the adhesion's energy and area, and the smallest distance, in a state: that of the
  /// stepper of advance().
  void record(const ModelState& state, StepRecord& record);

 private:
  void begin(const ModelState& start, double time_step, BodyStepper& stepper, ContactPart& part);
  void keep_apart(ContactPart& part);
  void take_solution(BodyStepper& stepper, ContactPart& part);
  void add_sleeping(const ModelState& start, ContactPart& part);
  std::vector<double> intensities() const;
  void end_contacts(const ModelState& after);

  const Scene& scene_;
  const Model& model_;
  const SceneSurfaces& surfaces_;
  ContactStepOptions options_;
  std::unique_ptr<Detector> detector_;
  ContactHistory history_;
  SleepingContacts sleeping_;
  PartMotion motion_;
  ContactPasses passes_;
  EndCheck end_check_;
  ContactImpulses impulses_;
  ContactPoints points_;
  ContactRest rest_;
};

}  // namespace tetwarp

/// @file moving_bodies.hpp
/// MovingBodies: the bodies of a scene and what moves them, one part of a step at a time.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "host/simulate/contact_step/contact_step.hpp"
#include "host/simulate/run/body_sleep.hpp"
#include "host/simulate/start/rest_growth.hpp"
#include "host/simulate/state/host_state.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/simulation_state.hpp"
#include "host/simulate/state/step_attempt.hpp"
#include "host/simulate/state/step_count.hpp"
#include "host/simulate/step/scene_drive.hpp"
#include "host/simulate/step/step_clock.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// A part of a step, or a whole one.
struct StepPart {
  double end_time = 0;    ///< [s]
  double time_step = 0;   ///< its length [s]
  bool is_first = false;  ///< of the simulation
};

class MovingBodies {
 public:
  /// @param scene  kept by the caller; bodies that start too near each other change the start of
  ///               its model
  /// @param count, clock  kept by the caller
  /// @param growth  of a simulation that has started, whose handles have changed; nothing: it
  ///                starts
  MovingBodies(SimulatedScene& scene,
               StepCount& count,
               StepClock& clock,
               std::optional<RestGrowth> growth = {});

  /// Of bodies that started smaller.
  const RestGrowth& growth() const { return growth_; }

  /// Keeps the state, for go_back().
  void begin_step();
  void go_back();
  /// Moves the bodies over a part of a step, and adds how that went to an attempt.
  /// @returns what contact did; where the attempt is not completed, nothing has moved
  ContactPart advance(const StepPart& part, StepAttempt& attempt);
  /// After advance(), where the motion is kept: adds impulses and work.
  void end_part(const StepPart& part, StepSums& sums);
  /// Lets bodies at rest fall asleep.
  /// @param may_sleep  false: none does
  void end_step(bool may_sleep);

  HostState& state() { return state_; }
  SceneDrive& drive() { return drive_; }
  const SceneDrive& drive() const { return drive_; }
  BodyStepper& stepper() { return *stepper_; }
  const BodySleep& sleep() const { return sleep_; }
  /// Null: no two surfaces may touch.
  ContactStep* contact() { return contact_.get(); }

  BodyMemory memory() const;
  /// @throws std::invalid_argument  contacts are out of range; then nothing has changed
  void set_memory(const BodyMemory& memory);

 private:
  std::unique_ptr<ContactStep> make_contact();
  RestGrowth bring_apart(SimulatedScene& scene);
  std::unique_ptr<BodyStepper> make_stepper();
  ResidentState* watch();
  void fill_input(const StepPart& part);
  void slow_down(const std::vector<double>& fractions);
  bool solve(const StepPart& part, StepAttempt& attempt, ContactPart& contact);
  bool solve_without_waking(const StepPart& part, StepAttempt& attempt, ContactPart& contact);

  const SimulatedScene& scene_;
  StepCount& count_;
  StepClock& clock_;
  SceneDrive drive_;
  std::shared_ptr<RestFactors> rest_factors_;
  std::unique_ptr<ContactStep> contact_;
  RestGrowth growth_;  ///< of bodies that started smaller
  std::unique_ptr<BodyStepper> stepper_;
  ResidentState* resident_;  ///< of the stepper; null: every part copies the state to the host
  HostState state_;
  BodySleep sleep_;
  BodyMemory start_;  ///< of the step
  StepInput input_;   ///< kept, so that steps do not allocate it
};

}  // namespace tetwarp

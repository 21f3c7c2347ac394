/// @file divided_step.hpp
/// DividedStep: makes a step, in parts where an attempt as a whole is not good. Start at make(),
/// which lists what a step does.
#pragma once
#include <string>

#include "host/base/stopwatch.hpp"
#include "host/simulate/run/moving_bodies.hpp"
#include "host/simulate/state/last_step.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/step_attempt.hpp"
#include "host/simulate/state/step_count.hpp"
#include "host/simulate/state/step_division.hpp"

namespace tetwarp {

class DividedStep {
 public:
  /// @param scene, count, clock, bodies  kept by the caller
  DividedStep(const SimulatedScene& scene,
              StepCount& count,
              StepClock& clock,
              MovingBodies& bodies);

  /// Makes a step. @returns false if `progress` ended it; then all is as before
  /// @throws std::runtime_error  one line with step, bodies and remedy: positions would not be
  ///                             finite, or too many pairs are near each other, in the smallest
  ///                             parts too; or a fault of this library. Then all is as before
  bool step();
  /// Of the last step.
  const LastStep& last() const { return last_; }
  const DivisionState& division() const { return division_.state(); }
  /// Goes on after another last step.
  void restore(const LastStep& last, const DivisionState& division);

 private:
  bool make();
  void go_back();
  StepAttempt attempt(int parts);
  bool make_part(const StepPart& of, int parts, StepAttempt& attempt);
  StepPart part_of(int first, int past, int parts) const;
  void add_all_seconds(const StepAttempt& made);
  void accept(StepAttempt made);
  std::string failed_in(int parts);

  const SimulatedScene& scene_;
  StepCount& count_;
  StepClock& clock_;
  MovingBodies& bodies_;
  StepDivision division_;
  LastStep last_;
  Stopwatch stopwatch_;  ///< of the running step
  Stopwatch attempt_;    ///< of its running attempt
  StepSeconds seconds_;  ///< of all its attempts
};

}  // namespace tetwarp

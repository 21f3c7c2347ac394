/// @file body_sleep.hpp
/// BodySleep: lets bodies at rest and their contacts sleep, and wakes them.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "host/simulate/contact_step/contact_step.hpp"
#include "host/simulate/state/host_state.hpp"
#include "host/simulate/state/island_sleep.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

class BodySleep {
 public:
  /// @param contact  null: no two surfaces may touch
  BodySleep(const SimulatedScene& scene,
            ContactStep* contact,
            BodyStepper& stepper,
            HostState& state);

  /// Before the solve of a part of a step: wakes bodies whose inputs have changed.
  /// @param input  filled; gets what sleeps
  void begin_part(StepInput& input);
  /// Within a part, before anything has moved: wakes bodies and all that touches them.
  void wake(std::span<const std::int32_t> bodies, StepInput& input);
  /// After a step: bodies that are at rest for long enough fall asleep.
  /// @param may_sleep  false: none does, and times at rest start anew
  /// @param input      of the last part
  void end_step(bool may_sleep, const StepInput& input);

  /// Contact islands that sleep.
  std::int64_t count() const { return sleep_.group_count(links()); }
  const SleepState& state() const { return sleep_.state(); }
  void set_state(SleepState state) { sleep_.set_state(std::move(state)); }

 private:
  std::span<const BodyLink> links() const;

  double time_step_;
  ContactStep* contact_;
  BodyStepper& stepper_;
  HostState& bodies_;
  IslandSleep sleep_;
};

}  // namespace tetwarp

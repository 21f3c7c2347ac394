/// @file step_division.hpp
/// StepDivision: into how many parts a step is divided.
#pragma once
#include <cstdint>

#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/state/host_state.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/step_attempt.hpp"

namespace tetwarp {

/// What goes on from step to step.
struct DivisionState {
  std::int64_t held_steps = 0;       ///< successive ones whose bodies hardly moved
  std::int64_t undivided_steps = 0;  ///< to come, which contact does not divide
};

/// A step has a power of two of equal parts, up to SceneSolver::max_substeps: so many that no
/// rigid body turns too far in one, and twice as many where an attempt was not good.
class StepDivision {
 public:
  /// @param scene  kept by the caller
  explicit StepDivision(const SimulatedScene& scene) : scene_(scene) {}

  /// Parts of the first attempt.
  /// @param spin  largest of a rigid body [rad/s]
  int first_parts(double spin) const;
  bool can_double(int parts) const;
  /// Whether a part of an attempt is good enough; if not, the step is divided further.
  /// @param attempt    with the part
  /// @param contact    of the part
  /// @param time_step  of the part [s]
  /// @param state      after the part
  bool is_good(const StepAttempt& attempt,
               const ContactPart& contact,
               double time_step,
               HostState& state);
  /// The bodies are elsewhere than after the last is_good().
  void forget_counts() { inverted_ = -1; }
  /// The step is done.
  void accept(const StepAttempt& made);

  const DivisionState& state() const { return now_; }
  void set_state(const DivisionState& state);

 private:
  const SimulatedScene& scene_;
  std::int64_t inverted_ = -1;  ///< inverted tetrahedra in the state; -1: not counted
  DivisionState now_;
};

}  // namespace tetwarp

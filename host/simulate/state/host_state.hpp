/// @file host_state.hpp
/// HostState: the host's copy of the state of a stepper.
#pragma once
#include <vector>

#include "host/simulate/model/model.hpp"
#include "host/simulate/step/resident_state.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// The state after the last part of a step. Where a device keeps it, it is copied to the host when
/// it is read.
class HostState {
 public:
  /// @param model     kept by the caller
  /// @param moments   of turning_moments()
  /// @param stepper   kept by the caller; its state is the start of the model
  /// @param resident  of the stepper, keeps the state on its device; null: every part copies the
  ///                  state to the host
  HostState(const Model& model,
            std::vector<Point3> moments,
            BodyStepper& stepper,
            ResidentState* resident);

  /// The whole state.
  const ModelState& get();
  /// The state with the places that ResidentState::watch() names; others may be older.
  const ModelState& watched();
  /// Of a rigid body whose turn a step must resolve [rad/s].
  double largest_spin() const { return largest_spin_; }
  /// Before the last part. @pre the stepper keeps no state on a device
  const ModelState& before_part() const { return before_part_; }

  void set(const ModelState& next);
  /// The state without a device, to change velocities; then to be given to the stepper.
  ModelState& velocities_to_change() { return state_; }

  /// Keeps the state, to go back to.
  void keep();
  void go_back();
  /// Takes the state that the stepper has after a part of a step.
  /// @returns whether all its numbers are finite
  bool take();

 private:
  double spin_on_host() const;

  const Model& model_;
  std::vector<Point3> moments_;
  BodyStepper& stepper_;
  ResidentState* resident_;
  ModelState state_;
  bool is_here_ = true;  ///< whether all of state_ is that of the stepper
  double largest_spin_ = 0;
  double kept_spin_ = 0;
  ModelState kept_, before_part_;
};

}  // namespace tetwarp

/// @file resident_state.hpp
/// ResidentState: what a Simulator asks of a stepper whose state stays in memory of a device.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/model/model.hpp"
#include "host/simulate/step/step_sums.hpp"
#include "kernels/body/step_summary.hpp"

namespace tetwarp {

/// Entries of a state that the host reads before every step.
struct StatePlaces {
  std::vector<std::int32_t> nodes, rigid;  ///< of the model, no duplicates
  bool empty() const { return nodes.empty() && rigid.empty(); }
};

class ResidentState {
 public:
  virtual ~ResidentState() = default;
  /// Keeps a copy of the state in the same memory, to go back to.
  virtual void save() = 0;
  /// Goes back to it.
  virtual void restore() = 0;
  virtual StateCheck check() = 0;
  /// Sets the principal moments of inertia [kg m^2] of the rigid bodies whose spin check()
  /// compares, [rigid]; those of others are 0.
  virtual void watch_spins(const std::vector<Point3>& moments) = 0;
  /// Adds the impulses and the work of the step that has just been made, as add_step().
  virtual void add_sums(const StepInput& input, StepSums& sums) = 0;
  /// Sets what read_watched() reads.
  virtual void watch(const StatePlaces& places) = 0;
  /// Copies positions of the nodes, positions and rotations of the rigid bodies; no other entries
  /// of `state` change.
  virtual void read_watched(ModelState& state) = 0;
};

}  // namespace tetwarp

/// @file step_records.hpp
/// StepRecords: diagnostics of the last step, computed when they are asked for.
#pragma once
#include <optional>

#include <tetwarp/simulate.hpp>

#include "host/simulate/run/moving_bodies.hpp"
#include "host/simulate/state/last_step.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/step_count.hpp"

namespace tetwarp {

class StepRecords {
 public:
  /// @param scene, count, bodies, last  kept by the caller; `last`: of the last step
  StepRecords(const SimulatedScene& scene,
              const StepCount& count,
              MovingBodies& bodies,
              const LastStep& last)
      : scene_(scene), count_(count), bodies_(bodies), last_(last) {}

  const StepRecord& get();
  /// The bodies have moved.
  void forget() { record_.reset(); }

 private:
  void add_state(StepRecord& record);
  void add_forces(StepRecord& record) const;
  void add_counts(StepRecord& record) const;

  const SimulatedScene& scene_;
  const StepCount& count_;
  MovingBodies& bodies_;
  const LastStep& last_;
  std::optional<StepRecord> record_;
};

}  // namespace tetwarp

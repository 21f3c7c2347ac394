/// @file step_start.hpp
/// StepStart: what a step begins with, to go back to where it fails.
#pragma once
#include <optional>
#include <vector>

#include "host/simulate/contact_step/contact_memory.hpp"
#include "host/simulate/contact_step/contact_step.hpp"
#include "host/simulate/run/body_sleep.hpp"
#include "host/simulate/run/host_state.hpp"
#include "host/simulate/step/scene_drive.hpp"

namespace tetwarp {

class StepStart {
 public:
  /// @param contact  null: no two surfaces may touch
  StepStart(HostState& state, SceneDrive& drive, ContactStep* contact, BodySleep& sleep)
      : state_(state), drive_(drive), contact_(contact), sleep_(sleep) {}

  void keep();
  void go_back();

 private:
  HostState& state_;
  SceneDrive& drive_;
  ContactStep* contact_;
  BodySleep& sleep_;
  std::vector<std::optional<Point3>> handles_;
  std::vector<double> delays_;
  ContactMemory memory_;
  SleepState asleep_;
};

}  // namespace tetwarp

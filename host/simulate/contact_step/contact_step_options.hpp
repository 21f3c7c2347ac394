/// @file contact_step_options.hpp
/// Options of ContactStep.
#pragma once
#include <functional>
#include <memory>

#include <tetwarp/simulate.hpp>

namespace tetwarp {

class RestFactors;
class StepClock;

struct ContactStepOptions {
  Backend backend = Backend::cpu;
  int threads = 1;
  int device = 0;
  SimulateSkipOptions skip = {};
  bool sleeps = false;                        ///< bodies may sleep
  std::shared_ptr<RestFactors> factors = {};  ///< of elastic bodies, or null: own ones
  std::function<bool()> progress = {};        ///< false ends the step
  StepClock* clock = nullptr;  ///< kept by the caller: where it is over solves end with the
                               ///< velocities that they have; null: no limit
};

}  // namespace tetwarp

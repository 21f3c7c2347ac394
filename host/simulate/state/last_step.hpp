/// @file last_step.hpp
/// LastStep: what the last step did.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/step/step_sums.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

struct LastStep {
  StepOutcome outcome;  ///< of the parts of the step; its seconds are those of all attempts
  ContactPart contact;
  StepSums sums;
  std::int64_t substeps = 0;
  bool is_out_of_time = false;       ///< its solves ended by SimulateOptions::max_step_seconds
  std::vector<ContactPoint> points;  ///< at the end of the step
  double work = 0;                   ///< of all steps [J]
};

}  // namespace tetwarp

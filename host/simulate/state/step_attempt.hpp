/// @file step_attempt.hpp
/// StepAttempt: how a division of a step into parts went.
#pragma once
#include "host/simulate/contact_step/contact_part.hpp"
#include "host/simulate/step/step_sums.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

struct StepAttempt {
  bool is_completed = true;  ///< false: `progress` ended it
  bool is_good = true;       ///< converged, finite, no body turned too far or was held up
  bool is_finite = true;
  int parts = 0;             ///< that have been made
  bool is_given_up = false;  ///< with more parts the step may become better
  StepOutcome outcome;       ///< of all parts
  ContactPart contact;       ///< of all parts
  StepSums sums;             ///< of all parts
};

/// Adds counts of a later part, and its largest residual; no seconds.
void add_outcome(const StepOutcome& part, StepOutcome& sum);

}  // namespace tetwarp

/// @file contact_part.cpp
/// Adds the counts and seconds of parts of a step.
#include "host/simulate/contact_step/contact_part.hpp"

#include <algorithm>

namespace tetwarp {

void add_part(const ContactPart& part, ContactPart& sum) {
  sum.is_completed = sum.is_completed && part.is_completed;
  sum.converged = sum.converged && part.converged;
  sum.residual = std::max(sum.residual, part.residual);
  sum.contacts = part.contacts;
  sum.islands = part.islands;
  sum.passes += part.passes;
  sum.sweeps += part.sweeps;
  sum.outer_iterations += part.outer_iterations;
  sum.clamped_islands += part.clamped_islands;
  sum.stalled_scripts += part.stalled_scripts;
  sum.smallest_fraction = std::min(sum.smallest_fraction, part.smallest_fraction);
  sum.detection_seconds += part.detection_seconds;
  sum.contact_seconds += part.contact_seconds;
}

}  // namespace tetwarp

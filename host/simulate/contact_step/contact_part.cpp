/// @file contact_part.cpp
/// Adds the counts and seconds of parts of a step.
#include "host/simulate/contact_step/contact_part.hpp"

#include <algorithm>

#include "host/base/step_second_fields.hpp"

namespace tetwarp {

void add_part(const ContactPart& part, ContactPart& sum) {
  const auto& [is_completed, woken, converged, residual, contacts, islands, passes, sweeps,
               outer_iterations, clamped_islands, stalled_scripts, smallest_fraction, seconds] =
      part;
  sum.is_completed = sum.is_completed && is_completed;
  sum.converged = sum.converged && converged;
  sum.residual = std::max(sum.residual, residual);
  sum.contacts = contacts;
  sum.islands = islands;
  sum.passes += passes;
  sum.sweeps += sweeps;
  sum.outer_iterations += outer_iterations;
  sum.clamped_islands += clamped_islands;
  sum.stalled_scripts += stalled_scripts;
  sum.smallest_fraction = std::min(sum.smallest_fraction, smallest_fraction);
  add_seconds(seconds, sum.seconds);
}

}  // namespace tetwarp

/// @file step_attempt.cpp
/// Whether an attempt is good, and its sums over parts.
#include "host/simulate/state/step_attempt.hpp"

#include <algorithm>

namespace tetwarp {

void add_outcome(const StepOutcome& part, StepOutcome& sum) {
  const auto& [completed, converged, linear_iterations, linear_residual, skipped_rotations,
               skipped_blocks, seconds] = part;
  sum.converged = sum.converged && converged;
  sum.linear_iterations += linear_iterations;
  sum.linear_residual = std::max(sum.linear_residual, linear_residual);
  sum.skipped_rotations += skipped_rotations;
  sum.skipped_blocks += skipped_blocks;
}

}  // namespace tetwarp

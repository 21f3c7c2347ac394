/// @file step_attempt.cpp
/// Whether an attempt is good, and its sums over parts.
#include "host/simulate/run/step_attempt.hpp"

#include <algorithm>

namespace tetwarp {

void add_outcome(const StepOutcome& part, StepOutcome& sum) {
  sum.converged = sum.converged && part.converged;
  sum.linear_iterations += part.linear_iterations;
  sum.linear_residual = std::max(sum.linear_residual, part.linear_residual);
  sum.skipped_rotations += part.skipped_rotations;
  sum.skipped_blocks += part.skipped_blocks;
}

void add_seconds(const StepSeconds& part, StepSeconds& sum) {
  sum.forces += part.forces;
  sum.assembly += part.assembly;
  sum.linear += part.linear;
  sum.update += part.update;
}

}  // namespace tetwarp

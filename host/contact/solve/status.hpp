/// @file status.hpp
/// Residual of a whole problem and the status that follows from it.
#pragma once
#include <cmath>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"
#include "host/contact/problem/measure.hpp"
#include "host/contact/solve/engine_result.hpp"

namespace tetwarp {

/// Measures of the whole problem, summed over its islands.
struct WholeResidual {
  ContactSums sums;        ///< of the solution; contacts by their index in the problem
  ContactSums free;        ///< without impulses
  double free_square = 0;  ///< |q|^2

  /// The part of eta that an energy [J] contributes; infinity where anything is not finite.
  double eta_of(double square) const {
    return relative_error(std::sqrt(square), std::sqrt(free.eta) + std::sqrt(resolved_work(sums)));
  }
  double eta() const { return eta_of(sums.eta); }
  double fclib() const { return relative_error(std::sqrt(sums.fclib), std::sqrt(free_square)); }
  /// The smallest eta that rounding of the velocities leaves meaningful.
  double resolution() const { return eta_of(unresolved_energy(sums)); }
};

WholeResidual whole_residual(const std::vector<IslandOutcome>& outcomes);

/// Sets status and reason of a report. Converged: the residual and the imbalance are within the
/// tolerance, all numbers are finite, and rounding is below the tolerance.
/// @param solution  in: complete but for the status
void set_status(const EngineResult& result,
                const WholeResidual& whole,
                const ContactOptions& options,
                const SolveBudget& budget,
                ContactSolution& solution);

}  // namespace tetwarp

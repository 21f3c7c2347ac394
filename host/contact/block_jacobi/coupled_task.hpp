/// @file coupled_task.hpp
/// Input and output of a solve for an island whose blocks A couples.
#pragma once
#include <cstdint>

#include <tetwarp/contact.hpp>

#include "host/contact/problem/budget.hpp"
#include "kernels/contact/contact_numbers.hpp"

namespace tetwarp {

/// An island whose blocks A couples, and what its solve reads. Views cover the whole problem, in
/// memory of the executor unless stated otherwise.
struct CoupledTask {
  const ContactOptions& options;
  const ContactIsland& island;
  View<const std::int64_t> color_start;  ///< of all islands, in memory of the host
  ContactNumbers<double> numbers;
  View<const double> guess;       ///< impulses to start from, [3 slots]; empty: zero
  std::int64_t max_iterations;    ///< outer iterations
  SolveBudget* budget = nullptr;  ///< ends the iteration; null: no limits

  bool is_over() const { return budget != nullptr && budget->is_over(); }
};

/// Impulses and velocities of a whole problem, set in one island only.
struct CoupledSolution {
  View<const double> impulse;        ///< [3 slots]
  View<const double> body_velocity;  ///< [dofs]
};

}  // namespace tetwarp

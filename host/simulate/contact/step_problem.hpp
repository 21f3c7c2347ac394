/// @file step_problem.hpp
/// The ContactProblem of a step: rows of some coupling islands and of contacts on them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/contact/contact_islands.hpp"
#include "host/simulate/contact/contact_rows.hpp"
#include "host/simulate/stepper.hpp"

namespace tetwarp {

/// Keeps the arrays of the problem from step to step, and the pattern of A while the same islands
/// are taken.
class StepProblem {
 public:
  /// Sets A, J, b and the blocks. The caller sets friction, offsets, adhesion and guess.
  /// @param takes     [coupling islands] which are taken
  /// @param contacts  that are taken, ascending; they act on rows of islands that are taken
  void set(const StepSystem& system,
           const ContactIslands& islands,
           const ContactRows& rows,
           const std::vector<std::uint8_t>& takes,
           const std::vector<std::int32_t>& contacts);

  ContactProblem& problem() { return problem_; }
  /// Copies the velocities of its dofs to their blocks.
  void scatter(std::span<const double> dofs, std::vector<Point3>& velocity) const;

 private:
  void set_pattern(const StepSystem& system, const ContactIslands& islands);
  bool has_pattern(const SystemRows& rows) const;
  void set_values(const StepSystem& system);
  void set_jacobian(const ContactRows& rows, const std::vector<std::int32_t>& contacts);

  std::vector<std::uint8_t> takes_;           ///< of the pattern that the problem has
  std::vector<std::int32_t> column_, start_;  ///< of that pattern
  std::vector<std::int32_t> rows_;            ///< of the system, in the order of the problem
  std::vector<std::int32_t> dof_of_;          ///< [block_count], or -1
  ContactProblem problem_;
};

}  // namespace tetwarp

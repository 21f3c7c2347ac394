/// @file step_problem.hpp
/// StepProblem: the ContactProblem of some coupling islands of a step and of the contacts on them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/solve/problem/contact_islands.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/step/resident_contacts.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

/// Keeps the arrays of the problem from step to step, and its index arrays while the islands and
/// contacts in it stay the same. The numbers of A, J and b are computed here, or by the same stage
/// bodies on the device that steps the bodies.
class StepProblem {
 public:
  /// Sets the index arrays, and how the contacts act on the dofs.
  /// @param rows      of the system of the step
  /// @param takes     [coupling islands] 1: in the problem
  /// @param contacts  in the problem, ascending; they act on rows of its islands
  /// @returns whether any index array or place differs from that of the call before
  bool set_pattern(const SystemRows& rows,
                   const ContactIslands& islands,
                   const ContactRows& contact_rows,
                   const std::vector<std::uint8_t>& takes,
                   const std::vector<std::int32_t>& contacts);
  /// Computes the numbers of A, J and b in memory of the host.
  void set_numbers(const StepSystem& system);
  /// Sets numbers of A and J that pass a check of the index arrays: A = 1, and J full of ones.
  void set_sample();

  /// The caller sets friction, offsets, adhesion and guess.
  ContactProblem& problem() { return problem_; }
  const ProblemPlaces& places() const { return places_; }
  const ProblemArms& arms() const { return arms_; }
  /// Copies the velocities of the problem's dofs to their blocks.
  void scatter(std::span<const double> dofs, std::vector<Point3>& velocity) const;

 private:
  void set_system_pattern(const SystemRows& rows, const ContactIslands& islands);
  bool has_system_pattern(const SystemRows& rows) const;
  bool set_arms(const ContactRows& contact_rows, const std::vector<std::int32_t>& contacts);
  void set_jacobian_pattern(std::size_t contact_count);

  std::vector<std::uint8_t> takes_;           ///< those of the current pattern
  std::vector<std::int32_t> column_, start_;  ///< of the current pattern
  std::vector<std::int32_t> dof_of_;          ///< [block_count], or -1
  ContactProblem problem_;
  ProblemPlaces places_;
  ProblemArms arms_;
  std::vector<ArmPlace> arm_places_;     ///< of the current contacts, to compare with the next ones
  std::vector<std::int32_t> arm_block_;  ///< [arms] first block of the model
  std::vector<std::int32_t> next_block_;  ///< of the current contacts
};

}  // namespace tetwarp

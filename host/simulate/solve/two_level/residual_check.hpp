/// @file residual_check.hpp
/// ResidualCheck: the residual eta of a two-level iterate on the host.
#pragma once
#include <functional>
#include <vector>

#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/two_level_step.hpp"
#include "kernels/contact/residual_check.hpp"

namespace tetwarp {

/// Finds the velocities that impulses cause, and eta at these; see kernels/contact.
class ResidualCheck {
 public:
  /// @param blocks, step  kept by the caller
  ResidualCheck(const TouchingBlocks& blocks, TwoLevelStep& step, ContactSwitches switches)
      : blocks_(blocks), step_(step), switches_(switches) {}

  /// Call after TouchingBlocks::set().
  /// @param lists  kept by the caller
  /// @param free   u without impulses, [3 contacts]; kept by the caller
  void set(const CompliantLists& lists, const std::vector<double>& free);
  /// Whether M^-1 may be far below A^-1.
  bool is_needed() const { return is_needed_; }
  /// Call after TwoLevelStep::run(), whose defect is that of the iterate.
  /// @param x         velocities, [rows][3] [m/s]
  /// @param impulse   r, [3 contacts] [N s]
  /// @param velocity  u at x, [3 contacts] [m/s]
  /// @param work      r . (u - u without impulses) [J]
  /// @param goes_on   () -> whether to continue; asked every ten iterations
  /// @returns eta; infinite where the velocities are not found
  double run(const std::vector<double>& x,
             const std::vector<double>& impulse,
             const std::vector<double>& velocity,
             double work,
             const ResidualCheckLimits& limits,
             const std::function<bool()>& goes_on);

 private:
  bool find_caused_velocities(const std::vector<double>& x,
                              double negligible,
                              const std::function<bool()>& goes_on);

  const TouchingBlocks& blocks_;
  TwoLevelStep& step_;
  ContactSwitches switches_;
  const std::vector<double>* free_ = nullptr;
  bool is_needed_ = false;
  std::vector<ContactConstants<double>> lower_;  ///< with lower bounds of blocks of J A^-1 J^T
  std::vector<double> solution_, defect_, preconditioned_, direction_, product_;  ///< [rows][3]
  std::vector<double> zeros_;                                                     ///< [3 contacts]
  std::vector<double> velocity_;  ///< of contacts at the velocities that are caused, [3 contacts]
};

}  // namespace tetwarp

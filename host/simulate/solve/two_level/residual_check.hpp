/// @file residual_check.hpp
/// The residual eta of a two-level iterate, from velocities that its impulses cause.
#pragma once
#include <functional>
#include <vector>

#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/two_level_step.hpp"

namespace tetwarp {

/// The errors of the iteration are measured in M. Of bodies that are joined to others, and of
/// cloth, M^-1 is far below A^-1, so that these errors are too small. Here velocities v' with
///
///     A v' = b + J^T r
///
/// are found by conjugate gradients with M^-1 as preconditioner, to a fifth of the way in the norm
/// of A, and eta is estimated from above as by the contact solver (contact_bound.hpp), whose blocks
/// of J A^-1 J^T are those of M^-1 at least.
class ResidualCheck {
 public:
  struct Limits {
    double tolerance = 0;    ///< of eta
    double least_scale = 0;  ///< of the energies that eta is relative to, at least [sqrt(J)]
  };

  /// @param blocks, step  kept by the caller
  ResidualCheck(const TouchingBlocks& blocks, TwoLevelStep& step, ContactSwitches switches)
      : blocks_(blocks), step_(step), switches_(switches) {}

  /// Call after TouchingBlocks::set().
  /// @param lists  kept by the caller
  /// @param free   u without impulses, [3 contacts]; kept by the caller
  void set(const CompliantLists& lists, const std::vector<double>& free);
  /// Whether M^-1 may be far below A^-1.
  bool is_needed() const { return is_needed_; }
  /// @param x         velocities, [rows][3] [m/s]
  /// @param stepped   x + M^-1 d, d = b + J^T r - A x, after TwoLevelStep::run()
  /// @param impulse   r, [3 contacts] [N s]
  /// @param velocity  u at x, [3 contacts] [m/s]
  /// @param goes_on   () -> whether to continue; asked every ten iterations
  /// @returns eta; infinite where the velocities are not found
  double run(const std::vector<double>& x,
             const std::vector<double>& stepped,
             const std::vector<double>& impulse,
             const std::vector<double>& velocity,
             const Limits& limits,
             const std::function<bool()>& goes_on);

 private:
  void find_lower(std::size_t contact);
  bool find_consistent(const std::vector<double>& x,
                       const std::vector<double>& stepped,
                       double negligible,
                       const std::function<bool()>& goes_on);
  double eta_of(const Limits& limits,
                const std::vector<double>& impulse,
                const std::vector<double>& velocity) const;

  const TouchingBlocks& blocks_;
  TwoLevelStep& step_;
  ContactSwitches switches_;
  const CompliantLists* lists_ = nullptr;
  const std::vector<double>* free_ = nullptr;
  bool is_needed_ = false;
  std::vector<ContactConstants<double>> lower_;  ///< with lower bounds of blocks of J A^-1 J^T
  std::vector<double> solution_, defect_, preconditioned_, direction_, zeros_;  ///< [rows][3]
  std::vector<double> image_;     ///< as TouchingBlocks has y
  std::vector<double> velocity_;  ///< J v' + w, [3 contacts]
  std::vector<double> gains_;     ///< squares of the steps in the norm of A
};

}  // namespace tetwarp

/// @file touching_newton.hpp
/// Newton's method on the velocities of bodies that touch and the impulses of their contacts.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/solve/two_level/touching_matrix.hpp"
#include "kernels/contact/coupled_control.hpp"

namespace tetwarp {

/// For contacts without friction: where many stick on a stiff sheet, it fails too often. A step
/// solves the equations, and the laws linearized (ContactTangentOp):
///
///     (A + J^T (H + K) J) dv = b + J^T r - A v - J^T g,   dr = -g - (H + K) J dv
///
/// with H and g of all contacts and the springs K. It is shortened until the error shrinks.
class TouchingNewton {
 public:
  /// @param blocks  kept by the caller
  TouchingNewton(const TouchingBlocks& blocks, ContactSwitches switches)
      : blocks_(blocks), switches_(switches) {}

  /// Call after TouchingBlocks::set(). @param most_operations  of a step, multiplications
  /// @returns whether there is no friction and TouchingMatrix::set() finds few operations
  bool set(const StepSystem& system, const CompliantLists& lists, std::int64_t most_operations);
  /// Multiplications of a factorization.
  std::int64_t operations() const { return matrix_.operations(); }

  /// A step. @param defect   b + J^T r - A v, [rows][3]
  /// @param error     of x and impulse
  /// @param x         in and out, v
  /// @param impulse   in and out, r
  /// @param velocity  in: u; overwritten
  /// @returns whether there was a step
  bool step(const StepSystem& system,
            const std::vector<double>& defect,
            const CoupledError& error,
            std::vector<double>& x,
            std::vector<double>& impulse,
            std::vector<double>& velocity);

 private:
  static constexpr std::size_t errors_kept = 3;

  void linearize(const std::vector<double>& impulse, const std::vector<double>& velocity);
  void find_direction(const std::vector<double>& defect,
                      const std::vector<double>& x,
                      const std::vector<double>& velocity);
  double accepted_part(const CoupledError& error,
                       const std::vector<double>& impulse,
                       const std::vector<double>& velocity);

  const TouchingBlocks& blocks_;
  ContactSwitches switches_;
  TouchingMatrix matrix_;
  double softness_ = 0;         ///< of ContactTangentOp
  std::vector<double> errors_;  ///< the last ones
  std::vector<double> slope_;   ///< H + K, [contacts][9]
  std::vector<double> offset_;  ///< g, [3 contacts]
  std::vector<double> change_, impulse_change_, velocity_change_;
  std::vector<double> trial_impulse_, trial_velocity_;
  std::vector<std::int32_t> working_;
};

}  // namespace tetwarp

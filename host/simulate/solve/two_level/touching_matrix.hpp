/// @file touching_matrix.hpp
/// A + J^T H J of the bodies that touch, with its factors.
#pragma once
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/touching_blocks.hpp"
#include "host/simulate/step/cpu/block_lu.hpp"
#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

class TouchingMatrix {
 public:
  /// Sets the pattern: that of A, and the rows that a contact moves with each other.
  /// @param lists, blocks    kept by the caller
  /// @param most_operations  of a factorization, multiplications
  /// @returns whether it has at most so many; if not, there is no matrix
  bool set(const StepSystem& system,
           const CompliantLists& lists,
           const TouchingBlocks& blocks,
           std::int64_t most_operations);
  /// Multiplications of a factorization.
  std::int64_t operations() const { return lu_.operations(); }
  /// Factorizes. @param slope  H, [contacts][9], row by row
  /// @returns whether the matrix is regular
  bool factor(const StepSystem& system, const std::vector<double>& slope);
  /// Replaces the right-hand side by the solution. @param x  [rows][3]
  void solve(std::vector<double>& x) { lu_.solve(x); }

 private:
  void list_system(const StepSystem& system);
  void list_contacts();
  void add_contact(std::size_t contact, const double* slope);

  const CompliantLists* lists_ = nullptr;
  const TouchingBlocks* blocks_ = nullptr;
  BlockLu of_system_;  ///< of A alone, whose pattern stays as contacts come and go
  BlockLu lu_;
  std::vector<BlockLu::Entry> entries_;
  std::vector<std::int32_t> moved_;  ///< by one contact
};

}  // namespace tetwarp

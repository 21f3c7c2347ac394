/// @file row_range_lu.hpp
/// L U of the blocks of a system between rows that follow each other.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/step/cpu/block_lu.hpp"
#include "kernels/body/system_lists.hpp"

namespace tetwarp {

class RowRangeLu {
 public:
  /// Sets the pattern of rows [begin, end). The same as before: nothing is done.
  void set(const SystemRows& rows, std::int64_t begin, std::int64_t end);
  /// Blocks off the diagonal of the system.
  std::int64_t blocks() const { return static_cast<std::int64_t>(entries_.size()); }
  /// Multiplications of factor() and of solve().
  std::int64_t operations() const { return lu_.operations(); }
  std::int64_t solve_operations() const { return lu_.solve_operations(); }

  /// Factorizes. @param values  of the system, block by block, each column by column
  /// @returns whether all pivots are regular
  bool factor(const SystemRows& rows, View<const double> values);
  /// x = A^-1 x, [3 count]. @pre factor()
  void solve(std::span<double> x) { lu_.solve(x); }
  /// The same for three vectors at once, [3][3 count].
  void solve_three(std::span<double> x) { lu_.solve_three(x); }

 private:
  std::int32_t begin_ = 0, count_ = 0;
  BlockLu lu_;
  std::vector<BlockLu::Entry> entries_;
};

}  // namespace tetwarp

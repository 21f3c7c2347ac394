/// @file block_lu.hpp
/// L U of a sparse matrix of 3x3 blocks whose pattern is symmetric.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetwarp {

/// Without exchange of rows, in an order of little fill. Determinism: serial.
class BlockLu {
 public:
  /// A block of a row and a column.
  using Entry = std::array<std::int32_t, 2>;

  /// Sets which blocks there are, and the order.
  /// @param entries  all blocks off the diagonal, both of (i, j) and (j, i), each once; those on
  /// the
  ///                 diagonal are there always. The same as before: nothing is done
  void set_pattern(std::int32_t count, const std::vector<Entry>& entries);
  /// Multiplications of factor().
  std::int64_t operations() const { return operations_; }
  /// Multiplications of solve().
  std::int64_t solve_operations() const { return 18 * static_cast<std::int64_t>(row_.size()); }

  /// Sets all blocks to zero.
  void clear();
  /// Adds to a block of the pattern. @param block  row by row
  void add(std::int32_t row, std::int32_t column, const double* block);
  /// Factorizes. @returns whether all pivots are regular
  bool factor();
  /// x = A^-1 x, [3 count]. @pre factor()
  void solve(std::span<double> x);
  /// The same for three vectors at once, [3][3 count]: the numbers of three calls, except
  /// for signs of zeros.
  void solve_three(std::span<double> x);

 private:
  static constexpr std::int64_t block_size = 12;  ///< three columns of four, the last not used

  void find_order(const std::vector<Entry>& entries);
  void find_columns(const std::vector<Entry>& entries);
  void find_rows();
  double* lower(std::int64_t entry) { return lower_.data() + block_size * entry; }
  double* upper(std::int64_t entry) { return upper_.data() + block_size * entry; }
  bool factor_column(std::int32_t j);

  std::int32_t count_ = 0;
  std::int64_t operations_ = 0;
  std::vector<Entry> entries_;            ///< of the pattern
  std::vector<std::int32_t> place_;       ///< [count] place of a row in the order
  std::vector<std::int64_t> start_;       ///< [count + 1] blocks of a column, from the diagonal on
  std::vector<std::int32_t> row_;         ///< [blocks] ascending in a column
  std::vector<std::int64_t> row_start_;   ///< [count + 1] in row_entry_
  std::vector<std::int64_t> row_entry_;   ///< blocks left of the diagonal of each row, ascending
  std::vector<std::int32_t> row_column_;  ///< their columns
  std::vector<double> lower_, upper_;  ///< L and U^T, [blocks][block_size]; of U with its diagonal
  std::vector<double> inverse_;        ///< [count][9] of the pivots, row by row
  std::vector<std::int32_t> slot_;     ///< [count] place of a row in the column that is factorized
  std::vector<double> work_;           ///< [3 count]
  std::vector<double> four_;           ///< [3 count][4]
};

}  // namespace tetwarp

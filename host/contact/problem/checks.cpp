/// @file checks.cpp
/// Texts of numbers and indices, checks of arrays and of matrices.
#include "host/contact/problem/checks.hpp"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "host/contact/problem/matrix.hpp"
#include "kernels/contact/check_limits.hpp"

namespace tetwarp {

std::string text_of(double value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value);
  return std::string(text.data(), written.ptr);
}

std::string at(std::int64_t index) {
  std::string text = "[";
  return text.append(std::to_string(index)).append("]: ");
}

void check_size(const std::string& field,
                std::size_t size,
                std::int64_t expected,
                const char* meaning) {
  if (static_cast<std::int64_t>(size) == expected) return;
  throw ContactProblemError(field, ": " + std::to_string(size) + " entries, expected " +
                                       std::to_string(expected) + ": " + meaning);
}

void check_finite(const std::string& field, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isfinite(values[i])) continue;
    throw ContactProblemError(field, at(static_cast<std::int64_t>(i)) + text_of(values[i]) +
                                         " is not finite; correct it where the step is assembled");
  }
}

void check_not_negative(const std::string& field,
                        std::span<const double> values,
                        const char* remedy) {
  check_finite(field, values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] >= 0) continue;
    throw ContactProblemError(
        field, at(static_cast<std::int64_t>(i)) + text_of(values[i]) + " is negative; " + remedy);
  }
}

void check_rows(const std::string& field, const SparseMatrix& matrix) {
  constexpr std::int64_t limit = std::numeric_limits<std::int32_t>::max();
  if (matrix.rows < 0 || matrix.columns < 0 || matrix.rows > limit || matrix.columns > limit) {
    throw ContactProblemError(field, ": " + std::to_string(matrix.rows) + " rows and " +
                                         std::to_string(matrix.columns) +
                                         " columns; both must be from 0 to 2^31 - 1");
  }
  const std::vector<std::int64_t>& starts = matrix.row_start;
  const auto entries = static_cast<std::int64_t>(matrix.column.size());
  check_size(field + ".value", matrix.value.size(), entries, "one for each column index");
  if (matrix.rows == 0 && starts.empty() && entries == 0) return;
  check_size(field + ".row_start", starts.size(), matrix.rows + 1, "one per row and one more");
  if (starts.front() != 0) {
    throw ContactProblemError(field + ".row_start",
                              "[0]: " + std::to_string(starts.front()) + ", expected 0");
  }
  for (std::size_t row = 1; row < starts.size(); ++row) {
    if (starts[row - 1] <= starts[row]) continue;
    throw ContactProblemError(field + ".row_start",
                              at(static_cast<std::int64_t>(row)) + std::to_string(starts[row]) +
                                  " is less than the previous entry; row starts must not decrease");
  }
  if (starts.back() != entries) {
    throw ContactProblemError(field + ".row_start",
                              at(matrix.rows) + std::to_string(starts.back()) +
                                  ", but the entries stored are " + std::to_string(entries));
  }
  for (std::size_t e = 0; e < matrix.column.size(); ++e) {
    if (matrix.column[e] >= 0 && matrix.column[e] < matrix.columns) continue;
    throw ContactProblemError(field + ".column",
                              at(static_cast<std::int64_t>(e)) + std::to_string(matrix.column[e]) +
                                  ", expected 0 to " + std::to_string(matrix.columns - 1));
  }
  check_finite(field + ".value", matrix.value);
}

namespace {
/// Compares each entry above the diagonal with its mirror image, in one pass over the rows.
class SymmetryCheck {
 public:
  explicit SymmetryCheck(const SparseMatrix& system)
      : system_(system), cursor_(system.row_start), largest_(cursor_.size(), -1.0) {}

  void run() {
    for (std::size_t row = 0; row + 1 < cursor_.size(); ++row) {
      compare_unpaired(row, row);
      for (std::int64_t e = system_.row_start[row]; e < system_.row_start[row + 1]; ++e) {
        const std::size_t c = column(e);
        if (c <= row) continue;
        compare_unpaired(c, row);
        const bool found = cursor_[c] < system_.row_start[c + 1] && column(cursor_[c]) == row;
        compare(row, c, value(e), found ? value(cursor_[c]++) : 0.0);
      }
    }
  }

 private:
  double value(std::int64_t e) const { return system_.value[static_cast<std::size_t>(e)]; }
  std::size_t column(std::int64_t e) const {
    return static_cast<std::size_t>(system_.column[static_cast<std::size_t>(e)]);
  }

  /// Compares with 0 those entries of a row left of `end` whose mirror image is not stored.
  void compare_unpaired(std::size_t row, std::size_t end) {
    for (; cursor_[row] < system_.row_start[row + 1] && column(cursor_[row]) < end;
         ++cursor_[row]) {
      compare(row, column(cursor_[row]), value(cursor_[row]), 0.0);
    }
  }

  double largest_of(std::size_t row) {
    double& largest = largest_[row];
    if (largest >= 0) return largest;
    for (std::int64_t e = system_.row_start[row]; e < system_.row_start[row + 1]; ++e) {
      largest = std::max(largest, std::abs(value(e)));
    }
    return largest;
  }

  void compare(std::size_t row, std::size_t c, double entry, double mirrored) {
    if (std::abs(entry - mirrored) > asymmetry.host * std::abs(entry)) {
      check_difference(row, c, entry, mirrored);
    }
  }

  /// Throws unless the difference is small relative to the largest entry of either row.
  void check_difference(std::size_t row, std::size_t c, double entry, double mirrored) {
    const double difference = std::abs(entry - mirrored);
    if (difference <= asymmetry.host * std::max(largest_of(row), largest_of(c))) return;
    const std::string r = std::to_string(row);
    const std::string k = std::to_string(c);
    throw ContactProblemError("system", "(" + r + ", " + k + "): " + text_of(entry) + ", but (" +
                                            k + ", " + r + ") is " + text_of(mirrored) +
                                            "; store both triangles of a symmetric matrix");
  }

  const SparseMatrix& system_;
  std::vector<std::int64_t> cursor_;  ///< of each row: the first entry not compared so far
  std::vector<double> largest_;       ///< of each row: the largest |entry|; -1: not computed so far
};

bool is_positive(const SparseMatrix& system, std::int32_t begin, int size) {
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor,
                              largest_dense_block, largest_dense_block>;
  Block block = Block::Zero(size, size);
  for (int i = 0; i < size; ++i) {
    const auto row = static_cast<std::size_t>(begin) + static_cast<std::size_t>(i);
    for (std::int64_t e = system.row_start[row]; e < system.row_start[row + 1]; ++e) {
      const int j = system.column[static_cast<std::size_t>(e)] - begin;
      if (j >= 0 && j < size) block(i, j) = system.value[static_cast<std::size_t>(e)];
    }
  }
  const Eigen::LLT<Block> factor(block);
  if (factor.info() != Eigen::Success) return false;
  for (int i = 0; i < size; ++i) {
    const double pivot = factor.matrixLLT()(i, i) * factor.matrixLLT()(i, i);
    if (!(pivot > smallest_pivot.host * block(i, i))) return false;
  }
  return true;
}

bool is_large_block_positive(const SparseMatrix& system, std::int32_t begin, int size) {
  const Eigen::SparseMatrix<double> block = make_eigen(system).block(begin, begin, size, size);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(block);
  return factor.info() == Eigen::Success &&
         factor.vectorD().minCoeff() > smallest_pivot.host * block.diagonal().maxCoeff();
}
}  // namespace

void check_symmetric(const SparseMatrix& system) {
  SymmetryCheck(system).run();
}

void check_positive_blocks(const SparseMatrix& system, std::span<const std::int32_t> starts) {
  for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
    const int size = starts[b + 1] - starts[b];
    if (size <= largest_dense_block ? is_positive(system, starts[b], size)
                                    : is_large_block_positive(system, starts[b], size)) {
      continue;
    }
    throw ContactProblemError(
        "system", ": the block of dofs " + std::to_string(starts[b]) + " to " +
                      std::to_string(starts[b + 1] - 1) +
                      " is not positive definite; give every body mass and every axis inertia");
  }
}

}  // namespace tetwarp

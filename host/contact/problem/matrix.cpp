/// @file matrix.cpp
/// Sorts rows, expands dense blocks, copies matrices to Eigen, finds the blocks of A.
#include "host/contact/problem/matrix.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tetwarp {

bool has_sorted_rows(const SparseMatrix& matrix) {
  for (std::int64_t row = 0; row < matrix.rows; ++row) {
    const auto begin = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row)]);
    const auto end = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row) + 1]);
    for (std::size_t entry = begin + 1; entry < end; ++entry) {
      if (matrix.column[entry - 1] >= matrix.column[entry]) return false;
    }
  }
  return true;
}

SparseMatrix make_sorted(const SparseMatrix& matrix) {
  SparseMatrix sorted{matrix.rows, matrix.columns, {0}, {}, {}};
  sorted.row_start.reserve(static_cast<std::size_t>(matrix.rows) + 1);
  sorted.column.reserve(matrix.column.size());
  sorted.value.reserve(matrix.value.size());
  std::vector<std::pair<std::int32_t, double>> entries;
  for (std::size_t row = 0; row < static_cast<std::size_t>(matrix.rows); ++row) {
    entries.clear();
    for (std::int64_t e = matrix.row_start[row]; e < matrix.row_start[row + 1]; ++e) {
      const auto entry = static_cast<std::size_t>(e);
      entries.emplace_back(matrix.column[entry], matrix.value[entry]);
    }
    std::stable_sort(entries.begin(), entries.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    const std::size_t first = sorted.column.size();
    for (const auto& [column, value] : entries) {
      if (sorted.column.size() > first && sorted.column.back() == column) {
        sorted.value.back() += value;
      } else {
        sorted.column.push_back(column);
        sorted.value.push_back(value);
      }
    }
    sorted.row_start.push_back(static_cast<std::int64_t>(sorted.column.size()));
  }
  return sorted;
}

SparseMatrix make_rows(const SparseMatrix& blocks) {
  SparseMatrix rows{blocks.rows, blocks.columns, {0}, {}, {}};
  rows.column.reserve(blocks.value.size());
  rows.value.reserve(blocks.value.size());
  for (std::int64_t row = 0; row < blocks.rows; ++row) {
    for (std::int64_t column = 0; column < blocks.columns; ++column) {
      const std::int64_t block = row / 3 * (blocks.columns / 3) + column / 3;
      rows.column.push_back(static_cast<std::int32_t>(column));
      rows.value.push_back(
          blocks.value[static_cast<std::size_t>(9 * block + 3 * (row % 3) + column % 3)]);
    }
    rows.row_start.push_back(static_cast<std::int64_t>(rows.column.size()));
  }
  return rows;
}

Eigen::SparseMatrix<double> make_eigen(const SparseMatrix& matrix) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(matrix.value.size());
  for (std::int64_t row = 0; row < matrix.rows; ++row) {
    const auto begin = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row)]);
    const auto end = static_cast<std::size_t>(matrix.row_start[static_cast<std::size_t>(row) + 1]);
    for (std::size_t entry = begin; entry < end; ++entry) {
      triplets.emplace_back(static_cast<int>(row), matrix.column[entry], matrix.value[entry]);
    }
  }
  Eigen::SparseMatrix<double> result(static_cast<Eigen::Index>(matrix.rows),
                                     static_cast<Eigen::Index>(matrix.columns));
  result.setFromTriplets(triplets.begin(), triplets.end());
  return result;
}

std::vector<std::int32_t> blocks_of(const ContactProblem& problem) {
  constexpr std::int32_t largest_body = 12;
  constexpr std::int32_t node_size = 3;
  if (!problem.block_start.empty()) return problem.block_start;

  const SparseMatrix& system = problem.system;
  const auto dofs = static_cast<std::int32_t>(system.rows);
  // reach[d]: the last dof that is coupled to a dof at or before d.
  std::vector<std::int32_t> reach(static_cast<std::size_t>(dofs));
  std::iota(reach.begin(), reach.end(), 0);
  for (std::int32_t row = 0; row < dofs; ++row) {
    const auto r = static_cast<std::size_t>(row);
    std::int32_t low = row, high = row;
    for (std::int64_t e = system.row_start[r]; e < system.row_start[r + 1]; ++e) {
      const std::int32_t column = system.column[static_cast<std::size_t>(e)];
      // Stored zeros do not couple; files of other programs contain them.
      const std::int32_t other = system.value[static_cast<std::size_t>(e)] != 0 ? column : row;
      low = std::min(low, other);
      high = std::max(high, other);
    }
    reach[static_cast<std::size_t>(low)] = std::max(reach[static_cast<std::size_t>(low)], high);
  }
  std::vector<std::int32_t> starts{0};
  std::int32_t last = 0;
  for (std::int32_t d = 0; d < dofs; ++d) {
    last = std::max(last, reach[static_cast<std::size_t>(d)]);
    if (last > d) continue;
    const std::int32_t begin = starts.back();
    if (d + 1 - begin > largest_body) {
      for (std::int32_t cut = begin + node_size; cut <= d; cut += node_size) starts.push_back(cut);
    }
    starts.push_back(d + 1);
  }
  return starts;
}

}  // namespace tetwarp

/// @file block_lu.cpp
/// Order by least degree, columns from the left.
#include "host/simulate/step/cpu/block_lu.hpp"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/index_of.hpp"
#include "host/base/vector_view.hpp"
#include "host/simulate/step/cpu/vector_stages.hpp"

namespace tetwarp {
namespace {

/// The inverse of a 3x3 block. @param a  columns of four. @param inverse  out, row by row
bool invert_block(const double* a, double* inverse) {
  const auto at = [a](int i, int j) { return a[4 * j + i]; };
  double cofactor[9];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
      cofactor[3 * j + i] = at(p, r) * at(q, s) - at(p, s) * at(q, r);
    }
  }
  const double det = at(0, 0) * cofactor[0] + at(0, 1) * cofactor[3] + at(0, 2) * cofactor[6];
  const double factor = 1 / det;
  for (int e = 0; e < 9; ++e) inverse[e] = factor * cofactor[e];
  return std::isfinite(factor) && det != 0;
}

}  // namespace

void BlockLu::set_pattern(std::int32_t count, const std::vector<Entry>& entries) {
  if (count == count_ && entries == entries_) return;
  count_ = count;
  entries_ = entries;
  find_order(entries);
  find_columns(entries);
  find_rows();
}

void BlockLu::find_order(const std::vector<Entry>& entries) {
  std::vector<Eigen::Triplet<double>> graph;
  for (const auto& [row, column] : entries) graph.emplace_back(row, column, 1.0);
  for (std::int32_t i = 0; i < count_; ++i) graph.emplace_back(i, i, 1.0);
  Eigen::SparseMatrix<double> pattern(count_, count_);
  pattern.setFromTriplets(graph.begin(), graph.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern, order);
  place_.resize(index_of(count_));
  for (std::int32_t k = 0; k < count_; ++k) place_[index_of(order.indices()[k])] = k;
}

/// Rows of each column of L: those of the matrix, and those of the columns whose first row below
/// the diagonal it is.
void BlockLu::find_columns(const std::vector<Entry>& entries) {
  std::vector<std::vector<std::int32_t>> rows(index_of(count_));
  for (const auto& [row, column] : entries) {
    const std::int32_t i = place_[index_of(row)], j = place_[index_of(column)];
    if (i > j) rows[index_of(j)].push_back(i);
  }
  start_.assign(1, 0);
  row_.clear();
  operations_ = 0;
  for (std::int32_t j = 0; j < count_; ++j) {
    std::vector<std::int32_t>& own = rows[index_of(j)];
    std::ranges::sort(own);
    own.erase(std::unique(own.begin(), own.end()), own.end());
    row_.push_back(j);
    row_.insert(row_.end(), own.begin(), own.end());
    start_.push_back(static_cast<std::int64_t>(row_.size()));
    operations_ += 27 * static_cast<std::int64_t>(own.size() * (own.size() + 3));
    if (own.empty()) continue;
    std::vector<std::int32_t>& parent = rows[index_of(own.front())];
    parent.insert(parent.end(), own.begin() + 1, own.end());
    own = {};
  }
}

void BlockLu::find_rows() {
  row_start_.assign(index_of(count_) + 1, 0);
  const auto for_blocks = [&](const auto& visit) {
    for (std::int32_t j = 0; j < count_; ++j) {
      for (std::int64_t e = start_[index_of(j)] + 1; e < start_[index_of(j) + 1]; ++e) visit(j, e);
    }
  };
  for_blocks([&](std::int32_t, std::int64_t e) { ++row_start_[index_of(row_[index_of(e)]) + 1]; });
  for (std::size_t i = 0; i < index_of(count_); ++i) row_start_[i + 1] += row_start_[i];
  row_entry_.resize(index_of(row_start_.back()));
  row_column_.resize(row_entry_.size());
  std::vector<std::int64_t> next(row_start_.begin(), row_start_.end() - 1);
  for_blocks([&](std::int32_t j, std::int64_t e) {
    const std::size_t at = index_of(next[index_of(row_[index_of(e)])]++);
    row_entry_[at] = e;
    row_column_[at] = j;
  });
}

void BlockLu::clear() {
  lower_.assign(block_size * row_.size(), 0.0);
  upper_.assign(block_size * row_.size(), 0.0);
  inverse_.resize(9 * index_of(count_));
  slot_.assign(index_of(count_), -1);
  work_.resize(3 * index_of(count_));
}

void BlockLu::add(std::int32_t row, std::int32_t column, const double* block) {
  const std::int32_t i = place_[index_of(row)], j = place_[index_of(column)];
  const std::int32_t own = std::min(i, j);
  const auto begin = row_.begin() + start_[index_of(own)];
  const auto end = row_.begin() + start_[index_of(own) + 1];
  const std::int64_t entry = std::lower_bound(begin, end, std::max(i, j)) - row_.begin();
  double* const out = i < j ? upper(entry) : lower(entry);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) out[i < j ? 4 * a + b : 4 * b + a] += block[3 * a + b];
  }
}

bool BlockLu::factor_column(std::int32_t j) {
  const std::int64_t first = start_[index_of(j)], last = start_[index_of(j) + 1];
  for (std::int64_t e = first; e < last; ++e) {
    slot_[index_of(row_[index_of(e)])] = static_cast<std::int32_t>(e - first);
  }
  for (std::int64_t p = row_start_[index_of(j)]; p < row_start_[index_of(j) + 1]; ++p) {
    const std::int64_t e = row_entry_[index_of(p)];
    const std::int64_t count = start_[index_of(row_column_[index_of(p)]) + 1] - e;
    const std::int32_t* const rows = row_.data() + e;
    vector_stages().subtract_products(lower(e), rows, count, slot_.data(), upper(e), lower(first));
    vector_stages().subtract_products(upper(e + 1), rows + 1, count - 1, slot_.data(), lower(e),
                                      upper(first));
  }
  double* const inverse = inverse_.data() + 9 * index_of(j);
  if (!invert_block(lower(first), inverse)) return false;
  for (std::int64_t e = first + 1; e < last; ++e) {
    double* const own = lower(e);
    double x[9];
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) {
        x[3 * c + i] =
            own[i] * inverse[c] + own[4 + i] * inverse[3 + c] + own[8 + i] * inverse[6 + c];
      }
    }
    for (int c = 0; c < 3; ++c) std::copy_n(x + 3 * c, 3, own + 4 * c);
  }
  return true;
}

bool BlockLu::factor() {
  for (std::int32_t j = 0; j < count_; ++j) {
    if (!factor_column(j)) return false;
  }
  return true;
}

void BlockLu::solve(std::span<double> x) {
  for (std::int32_t row = 0; row < count_; ++row) {
    std::copy_n(x.data() + 3 * row, 3, work_.data() + 3 * place_[index_of(row)]);
  }
  for (std::int32_t j = 0; j < count_; ++j) {
    const double* const own = work_.data() + 3 * j;
    if (own[0] == 0 && own[1] == 0 && own[2] == 0) continue;  // as in most columns of a sparse x
    for (std::int64_t e = start_[index_of(j)] + 1; e < start_[index_of(j) + 1]; ++e) {
      const double* const l = lower(e);
      double* const out = work_.data() + 3 * row_[index_of(e)];
      for (int i = 0; i < 3; ++i) out[i] -= l[i] * own[0] + l[4 + i] * own[1] + l[8 + i] * own[2];
    }
  }
  for (std::int32_t j = count_; j-- > 0;) {
    double* const own = work_.data() + 3 * j;
    double rest[3] = {own[0], own[1], own[2]};
    for (std::int64_t e = start_[index_of(j)] + 1; e < start_[index_of(j) + 1]; ++e) {
      const double* const u = upper(e);
      const double* const v = work_.data() + 3 * row_[index_of(e)];
      for (int i = 0; i < 3; ++i) {
        rest[i] -= u[4 * i] * v[0] + u[4 * i + 1] * v[1] + u[4 * i + 2] * v[2];
      }
    }
    const double* const inverse = inverse_.data() + 9 * index_of(j);
    for (int i = 0; i < 3; ++i) {
      own[i] =
          inverse[3 * i] * rest[0] + inverse[3 * i + 1] * rest[1] + inverse[3 * i + 2] * rest[2];
    }
  }
  for (std::int32_t row = 0; row < count_; ++row) {
    std::copy_n(work_.data() + 3 * place_[index_of(row)], 3, x.data() + 3 * row);
  }
}

void BlockLu::solve_three(std::span<double> x) {
  const std::size_t size = 3 * index_of(count_);
  four_.assign(4 * size, 0.0);
  const auto for_numbers = [&](const auto& visit) {
    for (std::size_t row = 0; row < index_of(count_); ++row) {
      double* const own = four_.data() + 12 * index_of(place_[row]);
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t i = 0; i < 3; ++i) visit(x[k * size + 3 * row + i], own[4 * i + k]);
      }
    }
  };
  for_numbers([](double from, double& to) { to = from; });
  vector_stages().substitute_four({view_of(std::as_const(row_)), view_of(std::as_const(start_)),
                                   lower_.data(), upper_.data(), inverse_.data()},
                                  four_.data());
  for_numbers([](double& to, double from) { to = from; });
}

}  // namespace tetwarp

/// @file condensed_matrix.cpp
/// Products of J with the columns of islands.
#include "host/simulate/solve/condensed/condensed_matrix.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_of.hpp"

namespace tetwarp {

void CondensedMatrix::clear(std::size_t count) {
  count_ = count;
  values_.assign(9 * count * count, 0.0);
  has_block_.assign(count * count, 0);
}

/// W is symmetric: what is above the diagonal is what is below, turned.
void CondensedMatrix::add(const BlockJacobian& jacobian, const CondensedIsland& island) {
  const auto [begin, end] = island.range();
  const std::size_t size = 3 * index_of(end - begin);
  for (const CondensedIsland::Contact& of_row : island.contacts()) {
    for (const CondensedIsland::Contact& of_column : island.contacts()) {
      const std::size_t row = index_of(of_row.number), column = index_of(of_column.number);
      if (column > row) break;
      double block[9] = {};
      jacobian.for_blocks(row, [&](std::size_t b) {
        if (!island.has(jacobian.row()[b])) return;
        const double* const j = jacobian.block(b);
        const double* const first = of_column.columns->data() + 3 * (jacobian.row()[b] - begin);
        for (std::size_t e = 0; e < 9; ++e) {
          const double *const along = j + e / 3 * 3, *const v = first + e % 3 * size;
          block[e] += along[0] * v[0] + along[1] * v[1] + along[2] * v[2];
        }
      });
      double* const own = values_.data() + 9 * (row * count_ + column);
      double* const mirror = values_.data() + 9 * (column * count_ + row);
      has_block_[row * count_ + column] = has_block_[column * count_ + row] = 1;
      for (std::size_t e = 0; e < 9; ++e) {
        const std::size_t turned = e % 3 * 3 + e / 3;
        own[e] += row == column ? block[std::max(e, turned)] : block[e];
        if (row != column) mirror[turned] += block[e];
      }
    }
  }
}

bool CondensedMatrix::is_valid() const {
  if (!std::ranges::all_of(values_, [](double value) { return std::isfinite(value); })) {
    return false;
  }
  for (std::size_t c = 0; c < count_; ++c) {
    const double* const own = block(c, c);
    if (!(own[0] > 0 && own[4] > 0 && own[8] > 0)) return false;
  }
  return true;
}

void CondensedMatrix::copy(SparseMatrix& w) const {
  w.rows = w.columns = static_cast<std::int64_t>(3 * count_);
  w.row_start.assign(1, 0);
  w.column.clear();
  w.value.clear();
  for (std::size_t row = 0; row < 3 * count_; ++row) {
    for (std::size_t c = 0; c < count_; ++c) {
      if (has_block_[row / 3 * count_ + c] == 0) continue;
      const double* const own = block(row / 3, c) + 3 * (row % 3);
      w.value.insert(w.value.end(), own, own + 3);
      for (std::size_t b = 0; b < 3; ++b) w.column.push_back(static_cast<std::int32_t>(3 * c + b));
    }
    w.row_start.push_back(static_cast<std::int64_t>(w.column.size()));
  }
}

void CondensedMatrix::subtract(const std::vector<double>& normal,
                               std::vector<double>& velocity) const {
  for (std::size_t row = 0; row < 3 * count_; ++row) {
    for (std::size_t c = 0; c < count_; ++c) {
      velocity[row] -= block(row / 3, c)[3 * (row % 3)] * normal[c];
    }
  }
}

}  // namespace tetwarp

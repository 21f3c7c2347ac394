/// @file island_factors.cpp
/// Factors of the blocks between the unknowns of an island.
#include "host/simulate/step/cpu/island_factors.hpp"

#include <algorithm>
#include <limits>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

constexpr std::int64_t least_rows = 32, most_rows = 2048;

}  // namespace

std::int64_t IslandFactors::find_worth(const SystemRows& rows,
                                       std::int64_t begin,
                                       std::int64_t end) {
  if (row_count_ == end - begin) return worth_;
  row_count_ = end - begin;
  lu_ = nullptr;
  worth_ = std::numeric_limits<std::int64_t>::max();
  if (row_count_ < least_rows || row_count_ > most_rows) return worth_;
  lu_ = std::make_unique<RowRangeLu>();
  lu_->set(rows, begin, end);
  constexpr std::int64_t of_row = 36, of_block = 9;  // multiplications of an iteration
  worth_ = lu_->operations() / (of_row * row_count_ + of_block * (lu_->blocks() + row_count_));
  x_.resize(3 * index_of(row_count_));
  return worth_;
}

void IslandFactors::solve(const GradientArrays<double>& a, std::int64_t begin) {
  is_made_ = lu_->factor(a.rows, a.values);
  if (!is_made_) return;
  std::copy_n(a.load.data + 3 * begin, 3 * row_count_, x_.data());
  lu_->solve(x_);
  std::ranges::copy(x_, a.x.data + 3 * begin);
}

}  // namespace tetwarp

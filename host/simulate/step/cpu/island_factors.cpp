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
  std::vector<BlockLu::Entry> entries;
  for (std::int64_t row = begin; row < end; ++row) {
    for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
      if (rows.column[k] == row) continue;
      entries.push_back({static_cast<std::int32_t>(row - begin),
                         static_cast<std::int32_t>(rows.column[k] - begin)});
    }
  }
  lu_ = std::make_unique<BlockLu>();
  lu_->set_pattern(static_cast<std::int32_t>(row_count_), entries);
  constexpr std::int64_t of_row = 36, of_block = 9;  // multiplications of an iteration
  const std::int64_t blocks = std::ssize(entries) + row_count_;
  worth_ = lu_->operations() / (of_row * row_count_ + of_block * blocks);
  x_.resize(3 * index_of(row_count_));
  return worth_;
}

/// The blocks of the system are stored column by column.
void IslandFactors::solve(const GradientArrays<double>& a, std::int64_t begin) {
  lu_->clear();
  for (std::int64_t row = begin; row < begin + row_count_; ++row) {
    for (std::int32_t k = a.rows.start[row]; k < a.rows.free_end[row]; ++k) {
      const double* const own = a.values.data + 9 * std::int64_t{k};
      const double block[9] = {own[0], own[3], own[6], own[1], own[4],
                               own[7], own[2], own[5], own[8]};
      lu_->add(static_cast<std::int32_t>(row - begin),
               static_cast<std::int32_t>(a.rows.column[k] - begin), block);
    }
  }
  if (!lu_->factor()) return;
  std::copy_n(a.load.data + 3 * begin, 3 * row_count_, x_.data());
  lu_->solve(x_);
  std::ranges::copy(x_, a.x.data + 3 * begin);
}

}  // namespace tetwarp

/// @file row_range_lu.cpp
/// Takes the blocks of the rows from those of the system.
#include "host/simulate/step/cpu/row_range_lu.hpp"

namespace tetwarp {

void RowRangeLu::set(const SystemRows& rows, std::int64_t begin, std::int64_t end) {
  begin_ = begin;
  count_ = end - begin;
  entries_.clear();
  for (std::int64_t row = begin; row < end; ++row) {
    for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
      if (rows.column[k] == row) continue;
      entries_.push_back({static_cast<std::int32_t>(row - begin),
                          static_cast<std::int32_t>(rows.column[k] - begin)});
    }
  }
  lu_.set_pattern(static_cast<std::int32_t>(count_), entries_);
}

bool RowRangeLu::factor(const SystemRows& rows, View<const double> values) {
  lu_.clear();
  for (std::int64_t row = begin_; row < begin_ + count_; ++row) {
    for (std::int32_t k = rows.start[row]; k < rows.free_end[row]; ++k) {
      const double* const own = values.data + 9 * std::int64_t{k};
      const double block[9] = {own[0], own[3], own[6], own[1], own[4],
                               own[7], own[2], own[5], own[8]};
      lu_.add(static_cast<std::int32_t>(row - begin_),
              static_cast<std::int32_t>(rows.column[k] - begin_), block);
    }
  }
  return lu_.factor();
}

}  // namespace tetwarp

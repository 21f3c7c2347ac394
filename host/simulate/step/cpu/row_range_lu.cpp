/// @file row_range_lu.cpp
/// Takes the blocks of the rows from those of the system.
#include "host/simulate/step/cpu/row_range_lu.hpp"

#include "host/simulate/step/cpu/system_blocks.hpp"

namespace tetwarp {

void RowRangeLu::set(const SystemRows& rows, std::int64_t begin, std::int64_t end) {
  begin_ = static_cast<std::int32_t>(begin);
  count_ = static_cast<std::int32_t>(end - begin);
  entries_.clear();
  for (std::int32_t row = 0; row < count_; ++row) {
    list_system_row(rows, begin_ + row, row, entries_);
  }
  lu_.set_pattern(count_, entries_);
}

bool RowRangeLu::factor(const SystemRows& rows, View<const double> values) {
  lu_.clear();
  for (std::int32_t row = 0; row < count_; ++row) {
    add_system_row(rows, values, begin_ + row, row, lu_);
  }
  return lu_.factor();
}

}  // namespace tetwarp

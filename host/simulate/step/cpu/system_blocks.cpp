/// @file system_blocks.cpp
/// The system has blocks column by column, BlockLu takes them row by row.
#include "host/simulate/step/cpu/system_blocks.hpp"

namespace tetwarp {

void list_system_row(const SystemRows& rows,
                     std::int32_t place,
                     std::int32_t row,
                     std::vector<BlockLu::Entry>& entries) {
  for (std::int32_t k = rows.start[place]; k < rows.free_end[place]; ++k) {
    const std::int32_t column = rows.column[k];
    if (column != place) entries.push_back({row, row + column - place});
  }
}

void add_system_row(const SystemRows& rows,
                    View<const double> values,
                    std::int32_t place,
                    std::int32_t row,
                    BlockLu& lu) {
  for (std::int32_t k = rows.start[place]; k < rows.free_end[place]; ++k) {
    const double* const a = values.data + 9 * std::int64_t{k};
    const double block[9] = {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
    lu.add(row, row + rows.column[k] - place, block);
  }
}

}  // namespace tetwarp

/// @file structure_parts.hpp
/// Parts from which the structures of both forms are made.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/contact/structure/structure.hpp"

namespace tetwarp {

/// The place of each item in an order.
inline std::vector<std::int32_t> places_of(const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[index_of(order[i])] = static_cast<std::int32_t>(i);
  }
  return place;
}

/// First scalar row of each contact, then the number of rows.
inline std::vector<std::int64_t> contact_rows(std::int64_t contacts) {
  std::vector<std::int64_t> starts(index_of(contacts) + 1);
  for (std::size_t c = 0; c < starts.size(); ++c) starts[c] = 3 * static_cast<std::int64_t>(c);
  return starts;
}

/// The block columns in which each range of scalar rows has entries, in increasing order.
/// @param row_start    first scalar row of each range, then the number of rows
/// @param blocks       number of block columns
/// @param block_of     (column) -> block column
/// @param keeps_zeros  whether stored zeros count as entries
template <class BlockOf>
Lists block_columns(const SparseMatrix& matrix,
                    const std::vector<std::int64_t>& row_start,
                    std::int64_t blocks,
                    const BlockOf& block_of,
                    bool keeps_zeros) {
  Lists rows;
  std::vector<std::int32_t> touched;
  std::vector<std::size_t> last_range;  // with this block
  last_range.assign(index_of(blocks), row_start.size());
  for (std::size_t b = 0; b + 1 < row_start.size(); ++b) {
    touched.clear();
    const std::int64_t last = matrix.row_start[index_of(row_start[b + 1])];
    for (std::int64_t e = matrix.row_start[index_of(row_start[b])]; e < last; ++e) {
      if (!keeps_zeros && matrix.value[index_of(e)] == 0) continue;
      const std::int32_t block = block_of(matrix.column[index_of(e)]);
      if (std::exchange(last_range[index_of(block)], b) != b) touched.push_back(block);
    }
    std::sort(touched.begin(), touched.end());
    rows.item.insert(rows.item.end(), touched.begin(), touched.end());
    rows.close_list();
  }
  return rows;
}

/// Moves the order of the contacts into a structure and sets its islands.
void take_order(ContactStructure& structure, ContactOrder order);

}  // namespace tetwarp

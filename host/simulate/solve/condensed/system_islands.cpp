/// @file system_islands.cpp
/// Lists rows by their islands, where the system has changed.
#include "host/simulate/solve/condensed/system_islands.hpp"

#include <algorithm>
#include <iterator>

#include "host/base/index_of.hpp"

namespace tetwarp {
namespace {

/// Copies a view. @returns whether that changes the list
bool renew(View<const std::int32_t> from, std::vector<std::int32_t>& list) {
  if (std::equal(from.data, from.data + from.size, list.begin(), list.end())) return false;
  list.assign(from.data, from.data + from.size);
  return true;
}

}  // namespace

bool SystemIslands::set(const SystemRows& rows, const ContactIslands& islands) {
  bool is_new = renew(rows.block_of, block_of_);
  is_new = renew(rows.start, start_) || is_new;
  is_new = renew(rows.column, column_) || is_new;
  is_new = is_new || std::ssize(of_row_) != rows.unknown_count;
  if (!is_new) return false;
  ranges_.assign(index_of(islands.count()), {});
  of_row_.clear();
  row_of_block_.assign(index_of(rows.count), -1);
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t block = rows.block_of[row], island = islands.of_block(block);
    Range& own = ranges_[index_of(island)];
    if (own.end == 0) own.begin = row;
    own.end = row + 1;
    of_row_.push_back(island);
    row_of_block_[index_of(block)] = row;
  }
  return true;
}

}  // namespace tetwarp

/// @file element_lists.hpp
/// Elements and springs as the rows of the system that they couple.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/index_of.hpp"
#include "host/simulate/step/system_pattern.hpp"

namespace tetwarp {

inline std::int32_t checked_int32(std::int64_t value) {
  if (value > std::numeric_limits<std::int32_t>::max()) {
    throw std::invalid_argument("simulation: the system has more than 2^31 entries");
  }
  return static_cast<std::int32_t>(value);
}

/// Elements of one kind as the rows of their slots; -1 for slots that are not used.
template <int slots>
struct Elements {
  std::vector<std::array<std::int32_t, slots>> rows;

  /// Items of every row: element * slots + slot, ascending.
  ItemArrays incidences(std::int32_t row_count) const {
    ItemArrays lists;
    if (rows.empty()) return lists;
    if (rows.size() > std::numeric_limits<std::uint32_t>::max() / (slots * slots)) {
      throw std::invalid_argument("simulation: " + std::to_string(rows.size()) +
                                  " elements or springs of one kind are too many");
    }
    std::vector<std::int64_t> count(index_of(row_count) + 1);
    for (const auto& element : rows) {
      for (const std::int32_t row : element) {
        if (row >= 0) ++count[index_of(row) + 1];
      }
    }
    for (std::size_t r = 1; r < count.size(); ++r) count[r] += count[r - 1];
    for (const std::int64_t c : count) lists.start.push_back(checked_int32(c));
    lists.item.resize(index_of(count.back()));
    for (std::size_t e = 0; e < rows.size(); ++e) {
      for (int slot = 0; slot < slots; ++slot) {
        const std::int32_t row = rows[e][index_of(slot)];
        if (row < 0) continue;
        lists.item[index_of(count[index_of(row)]++)] =
            static_cast<std::uint32_t>(e) * slots + static_cast<std::uint32_t>(slot);
      }
    }
    return lists;
  }
};

/// Calls visit(column, block item) for what the elements at a row couple it with.
template <int slots, class Visit>
void for_each_coupling(const Elements<slots>& elements,
                       const ItemArrays& incidences,
                       std::int32_t row,
                       const Visit& visit) {
  if (incidences.start.empty()) return;
  for (std::int32_t k = incidences.start[index_of(row)]; k < incidences.start[index_of(row) + 1];
       ++k) {
    const std::uint32_t item = incidences.item[index_of(k)];
    const auto& columns = elements.rows[item / slots];
    for (std::uint32_t slot = 0; slot < slots; ++slot) {
      if (columns[slot] >= 0) visit(columns[slot], item * slots + slot);
    }
  }
}

}  // namespace tetwarp

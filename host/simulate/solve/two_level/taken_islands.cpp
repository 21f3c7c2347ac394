/// @file taken_islands.cpp
/// Finds the rows of the islands.
#include "host/simulate/solve/two_level/taken_islands.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {

void TakenIslands::set(const SystemRows& rows,
                       const ContactIslands& islands,
                       const std::vector<std::uint8_t>& takes,
                       const ElasticSpace& elastic) {
  islands_.clear();
  island_of_row_.assign(index_of(rows.unknown_count), -1);
  std::int32_t last = -1;
  for (std::int32_t row = 0; row < rows.unknown_count; ++row) {
    const std::int32_t island = islands.of_block(rows.block_of[row]);
    if (takes[index_of(island)] == 0) continue;
    if (island != last) {
      islands_.emplace_back();
      islands_.back().row_begin = row;
      islands_.back().is_coupled = islands.is_coupled(island);
      islands_.back().elastic = elastic.body_of_row(row);
      last = island;
    }
    islands_.back().row_end = row + 1;
    island_of_row_[index_of(row)] = static_cast<std::int32_t>(islands_.size()) - 1;
  }
}

}  // namespace tetwarp

/// @file structure_parts.cpp
/// Takes the order of the contacts into a structure.
#include "host/contact/structure/structure_parts.hpp"

namespace tetwarp {

void take_order(ContactStructure& structure, ContactOrder order) {
  structure.contact_islands = static_cast<std::int64_t>(order.island_start.size()) - 1;
  for (std::size_t i = 0; i + 1 < order.island_start.size(); ++i) {
    ContactIsland island;
    island.slot_begin = order.island_start[i];
    island.slot_end = order.island_start[i + 1];
    island.color_begin = order.island_colors[i];
    island.color_end = order.island_colors[i + 1];
    structure.islands.push_back(island);
  }
  structure.contact_of_slot = std::move(order.contact_of_slot);
  structure.color_start = std::move(order.color_start);
}

}  // namespace tetwarp

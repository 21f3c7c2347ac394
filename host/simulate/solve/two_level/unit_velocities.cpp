/// @file unit_velocities.cpp
/// Sums the velocities over the blocks of the contact on elastic bodies.
#include "host/simulate/solve/two_level/unit_velocities.hpp"

#include <algorithm>

#include "host/base/index_of.hpp"

namespace tetwarp {

void set_unit_velocities(const TouchingBlocks& blocks,
                         ElasticGroups& groups,
                         std::size_t contact,
                         float* z) {
  const std::int32_t group = groups.of_contact(contact);
  const std::size_t size = index_of(groups.size(group));
  std::fill_n(z, 3 * size, 0.0F);
  blocks.for_blocks(contact, [&](std::size_t b) {
    const std::int32_t place = groups.place_of_block(b);
    if (place < 0) return;
    for (std::size_t a = 0; a < 3; ++a) {
      groups.add_velocities(group, place, blocks.rounded(b) + 3 * a, z + a * size);
    }
  });
}

}  // namespace tetwarp

/// @file unit_velocities.cpp
/// Sums the velocities over the parts of the contact on elastic bodies.
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
  for (std::int32_t p = blocks.part_start()[contact]; p < blocks.part_start()[contact + 1]; ++p) {
    const std::int32_t place = groups.place_of_part(index_of(p));
    if (place < 0) continue;
    const float* const j = blocks.rounded(blocks.part(p));
    for (std::size_t a = 0; a < 3; ++a) {
      groups.add_velocities(group, place, j + 3 * a, z + a * size);
    }
  }
}

}  // namespace tetwarp

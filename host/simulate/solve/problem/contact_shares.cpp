/// @file contact_shares.cpp
/// Divides coupling islands between the two solvers.
#include "host/simulate/solve/problem/contact_shares.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {

void ContactShares::divide(const ContactIslands& islands,
                           bool iterates_two_levels,
                           bool skips_islands) {
  soft.clear(islands.count());
  condensed.clear(islands.count());
  other.clear(islands.count());
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (!islands.has_contacts(i) && skips_islands) continue;
    (iterates_two_levels && islands.is_soft(i) ? soft : other).islands[index_of(i)] = 1;
  }
  for (std::size_t c = 0; c < islands.of_contact().size(); ++c) {
    const std::int32_t island = islands.of_contact()[c];
    if (island < 0) continue;
    (soft.islands[index_of(island)] != 0 ? soft : other)
        .contacts.push_back(static_cast<std::int32_t>(c));
  }
}

}  // namespace tetwarp

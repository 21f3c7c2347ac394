#include "host/simulate/contact/contact_shares.hpp"
#include "host/base/index_of.hpp"

namespace tetwarp {

ContactShare& ContactShares::share_of(const ContactIslands& islands,
                                      const ContactDivision& how,
                                      std::int32_t island) {
  if (!how.iterates_two_levels || !islands.is_soft(island)) return other;
  return is_left_[index_of(islands.contact_island(island))] != 0 ? soft : elastic;
}

void ContactShares::divide(const ContactIslands& islands, const ContactDivision& how) {
  for (ContactShare* share : {&elastic, &soft, &other}) share->clear(islands.count());
  is_left_.assign(index_of(islands.count()), 0);
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (how.compliant == nullptr || (*how.compliant)[index_of(i)] == 0) {
      is_left_[index_of(islands.contact_island(i))] = 1;
    }
  }
  for (std::int32_t i = 0; i < islands.count(); ++i) {
    if (!islands.has_contacts(i) && how.skips_islands) continue;
    share_of(islands, how, i).islands[index_of(i)] = 1;
  }
  for (std::size_t c = 0; c < islands.of_contact().size(); ++c) {
    const std::int32_t island = islands.of_contact()[c];
    if (island < 0) continue;
    share_of(islands, how, island).contacts.push_back(static_cast<std::int32_t>(c));
  }
}

}  // namespace tetwarp

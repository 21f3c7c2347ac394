/// @file color.hpp
/// Colors of contacts: contacts of one color share no group (a moving body, or a coupling in a
/// Delassus matrix), so they can be updated in parallel.
#pragma once
#include <cstdint>
#include <vector>

#include "host/contact/structure/islands.hpp"

namespace tetwarp {

struct ContactColors {
  std::vector<std::int32_t> of_contact;  ///< from 0
  std::int64_t steps = 0;                ///< neighbors and words of 64 colors that were examined
};

/// The color of each contact, in the order of the contacts: the lowest that no earlier contact of
/// its groups has.
/// @param groups       groups of each contact, in [0, group_count)
/// @param group_count  number of groups
///
/// Determinism: one thread of the host, for all back ends. Cost: the neighbors in groups of up to
/// 64 contacts; for larger groups one step per contact, and one per word that is full in one group
/// of the contact only. One body with n contacts costs n steps.
ContactColors color_contacts(const Lists& groups, std::int64_t group_count);

}  // namespace tetwarp

/// @file contact_color.hpp
/// Stage "color" of the contact solver: contacts of one color share no group (a moving body, or a
/// coupling in a Delassus matrix), so they can be updated in parallel.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/contact/vector_bodies.hpp"

namespace tetwarp {

constexpr std::int32_t uncolored = -1;

/// The groups of each contact and the contacts of each group, these in rising order.
struct ContactGroups {
  View<const std::int64_t> group_start;    ///< [contacts + 1]
  View<const std::int32_t> group;          ///< groups of each contact
  View<const std::int64_t> contact_start;  ///< [groups + 1]
  View<const std::int32_t> contact;        ///< contacts of each group
};

/// One index = one contact: if all neighbors of lower index have colors, assigns the lowest color
/// that none of them has; else leaves the contact for the next round. The result does not depend on
/// the order.
struct ContactColorBody {
  ContactGroups groups;
  View<std::int32_t> colors;

  TETWARP_HD void operator()(std::int64_t c) const {
    if (colors[c] != uncolored) return;
    // 64 colors at a time, one bit each.
    for (std::int32_t base = 0;; base += 64) {
      std::uint64_t taken = 0;
      for (std::int64_t k = groups.group_start[c]; k < groups.group_start[c + 1]; ++k) {
        const std::int32_t g = groups.group[k];
        for (std::int64_t n = groups.contact_start[g]; n < groups.contact_start[g + 1]; ++n) {
          const std::int32_t neighbor = groups.contact[n];
          if (neighbor >= c) break;
          const std::int32_t color = colors[neighbor];
          if (color == uncolored) return;
          if (color >= base && color < base + 64) taken |= std::uint64_t{1} << (color - base);
        }
      }
      if (~taken == 0) continue;
      std::int32_t color = base;
      for (; taken & 1; taken >>= 1) ++color;
      colors[c] = color;
      return;
    }
  }
};

/// One index = one contact: 1 if it has no color yet.
struct UncoloredBody {
  View<const std::int32_t> colors;
  TETWARP_HD PlainSums<1> operator()(std::int64_t c) const {
    return {{colors[c] == uncolored ? 1.0 : 0.0}};
  }
};

/// Colors all contacts greedily, in rounds; a serial executor needs one round.
/// @param exec    where to run
/// @param groups  groups shared by contacts
/// @param colors  out: colors from 0, [contacts]
///
/// Determinism: greedy in order of index, the same on every back end. Cost: per round and contact
/// the lower contacts of its groups.
template <class Exec>
void contact_color(Exec& exec, const ContactGroups& groups, View<std::int32_t> colors) {
  constexpr const char* label = "contact/color";
  exec.for_each(label, colors.size, FillBody<std::int32_t>{uncolored, colors});
  double waiting = 0;
  do {
    exec.for_each(label, colors.size, ContactColorBody{groups, colors});
    waiting =
        exec.template sum<PlainSums<1>>(label, 0, colors.size, UncoloredBody{colors}).value[0];
  } while (waiting > 0);
}

}  // namespace tetwarp

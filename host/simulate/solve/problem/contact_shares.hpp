/// @file contact_shares.hpp
/// Which solver takes which coupling islands and contacts of a step.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/simulate/solve/problem/contact_islands.hpp"

namespace tetwarp {

/// Coupling islands and contacts that one solver takes.
struct ContactShare {
  std::vector<std::uint8_t> islands;   ///< [coupling islands] which are taken
  std::vector<std::int32_t> contacts;  ///< ascending

  void clear(std::int32_t island_count) {
    islands.assign(static_cast<std::size_t>(island_count), 0);
    contacts.clear();
  }
  bool is_empty() const { return std::find(islands.begin(), islands.end(), 1) == islands.end(); }
  void take(const ContactShare& other) {
    for (std::size_t i = 0; i < islands.size(); ++i) islands[i] |= other.islands[i];
    contacts.insert(contacts.end(), other.contacts.begin(), other.contacts.end());
    std::sort(contacts.begin(), contacts.end());
  }
};

struct ContactShares {
  ContactShare soft;       ///< of the two-level iteration
  ContactShare condensed;  ///< of what it takes, on the host, what CondensedSolver takes from it
  ContactShare other;      ///< of the contact solver

  /// Contact islands of bodies that A couples go to the two-level iteration, all others to the
  /// contact solver.
  /// @param iterates_two_levels  false: the contact solver takes all
  /// @param skips_islands        coupling islands without contacts are not solved again
  void divide(const ContactIslands& islands, bool iterates_two_levels, bool skips_islands);
};

}  // namespace tetwarp

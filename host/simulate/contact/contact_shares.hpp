/// @file contact_shares.hpp
/// Which solver takes which coupling islands and contacts of a step.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/simulate/contact/contact_islands.hpp"

namespace tetwarp {

/// Coupling islands and contacts that one solver takes.
struct ContactShare {
  std::vector<std::uint8_t> islands;
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

/// How contact islands are divided.
struct ContactDivision {
  bool iterates_two_levels = true;  ///< false: the contact solver takes all of them
  bool skips_islands = true;        ///< coupling islands without contacts are not solved again
  const std::vector<std::uint8_t>* compliant = nullptr;  ///< [coupling islands] those that a device
                                                         ///< can take; null: none
};

class ContactShares {
 public:
  ContactShare elastic;  ///< of the two-level iteration on a device
  ContactShare soft;     ///< of the two-level iteration on the host
  ContactShare other;    ///< of the contact solver

  /// Contact islands of bodies that A couples go to the two-level iteration, on a device where it
  /// can take all coupling islands of a contact island; all others go to the contact solver.
  void divide(const ContactIslands& islands, const ContactDivision& how);

 private:
  ContactShare& share_of(const ContactIslands& islands,
                         const ContactDivision& how,
                         std::int32_t island);

  std::vector<std::uint8_t> is_left_;  ///< [islands] of roots: not for a device
};

}  // namespace tetwarp

/// @file packed_contacts.hpp
/// Sweeps over contacts one after the other, each with its numbers side by side in memory.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/simulate/solve/two_level/elastic_groups.hpp"
#include "host/simulate/solve/two_level/group_range.hpp"
#include "host/simulate/solve/two_level/touching_blocks.hpp"

namespace tetwarp {

/// For groups without a matrix (GroupMatrices). Contacts are packed when they are swept first.
class PackedContacts {
 public:
  /// @param blocks, groups  kept by the caller
  PackedContacts(const TouchingBlocks& blocks, ElasticGroups& groups)
      : blocks_(blocks), groups_(groups) {}

  /// Forgets all contacts; call after TouchingBlocks::set().
  void clear();
  /// Call for contacts whose group has changed.
  void forget_group_of(std::int32_t contact) {
    elastic_start_[static_cast<std::size_t>(contact)] = -1;
  }

  /// Sweeps over the contacts of a group and changes y.
  /// @param impulse  in and out, [3 list]
  /// @returns multiplications
  std::int64_t sweep(ContactSwitches switches,
                     const GroupRange& range,
                     const std::vector<std::int32_t>& list,
                     double* y,
                     double* impulse);

 private:
  void pack(std::size_t contact);
  void pack_elastic(std::size_t contact);
  void update(ContactSwitches switches, std::size_t contact, double* y, double* impulse);
  void gather(std::size_t contact, const double* y);
  void scatter(std::size_t contact, double* y) const;
  void add_push_of_elastic(std::size_t contact, const double* change);

  const TouchingBlocks& blocks_;
  ElasticGroups& groups_;
  std::vector<std::int64_t> start_;          ///< [contacts] in packed_, -1: not packed yet
  std::vector<std::int32_t> size_;           ///< [contacts] numbers of y, a multiple of 4
  std::vector<std::uint8_t> moves_rows_;     ///< [contacts] has a part that is not elastic
  std::vector<double> packed_;               ///< of a contact three rows of J, three of responses
  std::vector<std::int64_t> elastic_start_;  ///< [contacts] in elastic_response_, -1: not there yet
  std::vector<float> elastic_response_;      ///< of a contact set_unit_velocities()
  std::vector<double> gathered_;             ///< velocities of one contact
  std::int64_t operations_ = 0;              ///< of sweep()
};

}  // namespace tetwarp

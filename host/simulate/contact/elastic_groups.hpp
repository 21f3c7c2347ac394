/// @file elastic_groups.hpp
/// Contacts in groups of the same elastic bodies, so that a sweep moves few velocities per impulse.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "host/simulate/contact/elastic_space.hpp"

namespace tetwarp {

/// While a sweep visits a group, every impulse changes z, the velocities of the nodes that the
/// contacts of the group touch, and the pushes on these nodes are summed. finish() then changes the
/// velocities of all touched nodes of its bodies by these sums. Up to rounding the velocities are
/// those of changing all of them for every impulse; a contact changes tens instead of hundreds.
class ElasticGroups {
 public:
  /// Forgets all groups. The arguments are kept and must outlive the groups.
  /// @param part_start  [contacts + 1] parts of each contact
  /// @param part_row    [parts] the row that a part moves
  void set(const ElasticSpace& space,
           const std::vector<std::int32_t>& part_start,
           const std::vector<std::int32_t>& part_row);
  /// Sorts a list of contacts into the order of sweeps, one group after the other. If it has
  /// contacts that no list before had, groups are made anew of these and all before.
  /// @returns whether they were
  bool group(std::vector<std::int32_t>& list);

  /// The group of a contact that has been listed.
  std::int32_t of_contact(std::size_t contact) const { return group_of_[contact]; }
  /// Place in z and in the pushes of a part, -1: of no elastic body.
  std::int32_t place_of_part(std::size_t part) const { return place_of_part_[part]; }
  /// Numbers of z, a multiple of 8.
  std::int32_t size(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].size;
  }

  /// Whether z has all touched nodes of its bodies, as that of a group of many contacts.
  bool is_whole(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].is_whole;
  }

  /// Adds the velocities of a push on one node. @param place  place_of_part()
  /// @param push  impulse [N s], three. @param z  in and out [m/s], [size]
  void add_velocities(std::int32_t group, std::int32_t place, const double* push, double* z);

  /// Copies z from y, and sets the pushes to zero.
  void begin(std::int32_t group, const double* y);
  /// Adds the velocities of the pushes to y. @returns multiplications
  std::int64_t finish(std::int32_t group, double* y);

  /// z [m/s] and the pushes [N s] of the group that begin() was called for, [size].
  double* velocities() { return z_.data(); }
  double* pushes() { return push_.data(); }

  /// Appends the ranges {first, size} of y that finish() changes.
  template <class Ranges>
  void list_ranges(std::int32_t group, Ranges& ranges) const {
    for (const Body& own : groups_[static_cast<std::size_t>(group)].bodies) {
      const ElasticBody& body = space_->bodies()[static_cast<std::size_t>(own.body)];
      ranges.push_back({body.first, body.size});
    }
  }

 private:
  struct Body {
    std::int32_t body = 0;               ///< in ElasticSpace::bodies()
    std::int32_t first = 0, size = 0;    ///< in z; a multiple of 8
    std::vector<std::int32_t> slots;     ///< in ElasticBody::touched, ascending
    std::vector<float> compliance = {};  ///< [3 slots][size], empty: not needed yet
  };
  struct Group {
    std::vector<Body> bodies;
    std::int32_t size = 0;
    bool is_whole = false;
  };

  void list_slots(Group& group, std::span<const std::int32_t> contacts);
  void find_bodies(std::int32_t contact);
  void make_groups();
  void copy_compliance(Body& own) const;

  const ElasticSpace* space_ = nullptr;
  const std::vector<std::int32_t>*part_start_ = nullptr, *part_row_ = nullptr;
  std::vector<std::int32_t> listed_;  ///< all contacts that have been listed
  std::vector<Group> groups_;
  std::vector<std::int32_t> group_of_, place_of_part_;
  std::vector<std::array<std::int32_t, 2>> bodies_;  ///< of each contact, or -1
  std::vector<double> z_, push_;
};

}  // namespace tetwarp

/// @file elastic_groups.hpp
/// Contacts in groups of the same elastic bodies, so that a sweep moves few velocities per impulse.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "host/simulate/solve/two_level/elastic_space.hpp"

namespace tetwarp {

/// While a sweep visits a group, every impulse changes z, the velocities of the nodes that contacts
/// of the group touch, and is added to the pushes on these nodes. finish() then changes the
/// velocities of all touched nodes of the bodies by these pushes. Up to rounding the result is as
/// if every impulse changed all velocities; but an impulse changes tens of numbers, not hundreds.
class ElasticGroups {
 public:
  /// Forgets all groups. The arguments are kept and must outlive the groups.
  /// @param block_start  [contacts + 1] blocks of each contact
  /// @param block_row    [blocks] the row that each moves
  void set(const ElasticSpace& space,
           const std::vector<std::int32_t>& block_start,
           const std::vector<std::int32_t>& block_row);
  /// Sorts a list of contacts into the order of sweeps, one group after the other. Groups with
  /// contacts that were in no list before are made again.
  /// @param threads  any number: same groups
  /// @returns these groups
  const std::vector<std::int32_t>& group(std::vector<std::int32_t>& list, int threads);

  std::int32_t count() const { return static_cast<std::int32_t>(groups_.size()); }
  /// All contacts of a group that have been listed, ascending.
  const std::vector<std::int32_t>& contacts(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].contacts;
  }

  /// The group of a contact that has been listed.
  std::int32_t of_contact(std::size_t contact) const { return group_of_[contact]; }
  /// Place in z and in the pushes of a block, -1: of no elastic body.
  std::int32_t place_of_block(std::size_t block) const { return place_of_block_[block]; }
  /// The places of a block and of those that follow it.
  const std::int32_t* places_of_blocks(std::size_t first) const {
    return place_of_block_.data() + first;
  }
  /// Numbers of z, a multiple of 8.
  std::int32_t size(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].size;
  }

  /// Whether z has all touched nodes of its bodies, as that of a group of many contacts.
  bool is_whole(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].is_whole;
  }

  /// Whether all its contacts move nodes of elastic bodies alone.
  bool is_pure(std::int32_t group) const {
    return groups_[static_cast<std::size_t>(group)].is_pure;
  }

  /// Adds the velocities of a push on one node. @param place  place_of_block()
  /// @param push  impulse [N s], three. @param z  in and out [m/s], [size]
  void add_velocities(std::int32_t group, std::int32_t place, const float* push, float* z);

  /// Copies z from y, and sets the pushes to zero.
  void begin(std::int32_t group, const double* y);
  /// Adds the velocities of the pushes to y, one group after the other.
  /// @param threads  that share the numbers of the bodies
  /// @returns multiplications
  std::int64_t finish(std::span<const std::int32_t> groups, double* y, int threads);

  /// z [m/s] and the pushes [N s] since begin() of a group, [size].
  double* velocities(std::int32_t group) {
    return groups_[static_cast<std::size_t>(group)].z.data();
  }
  double* pushes(std::int32_t group) {
    return groups_[static_cast<std::size_t>(group)].push.data();
  }

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
    std::vector<std::int32_t> contacts;
    std::vector<Body> bodies = {};
    std::int32_t size = 0;
    bool is_whole = false, is_pure = true;
    std::vector<double> z = {}, push = {};
  };

  /// Numbers of a body that one task takes.
  struct Piece {
    std::int32_t body = 0;  ///< in ElasticSpace::bodies()
    std::int64_t begin = 0, end = 0;
    auto operator<=>(const Piece&) const = default;
  };

  void list_slots(Group& group);
  std::array<std::int32_t, 2> bodies_of(std::int32_t contact) const;
  std::int64_t finish(const Group& group, const Body& own, const Piece& piece, double* y) const;
  void copy_compliance(Body& own) const;

  const ElasticSpace* space_ = nullptr;
  const std::vector<std::int32_t>*block_start_ = nullptr, *block_row_ = nullptr;
  std::vector<Group> groups_;
  std::vector<std::int32_t> changed_;  ///< by the last group()
  std::map<std::array<std::int32_t, 2>, std::int32_t> group_of_bodies_;
  std::vector<Piece> finished_;  ///< of finish()
  std::vector<std::int32_t> group_of_, place_of_block_;
};

}  // namespace tetwarp

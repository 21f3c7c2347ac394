/// @file islands.hpp
/// Connected components of bodies and contacts, and the order in which contacts are swept.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace tetwarp {

/// Lists of int32 of different lengths, stored one after the other.
struct Lists {
  std::vector<std::int64_t> start = {0};  ///< [lists + 1]: first item of each list
  std::vector<std::int32_t> item;

  std::int64_t size() const { return static_cast<std::int64_t>(start.size()) - 1; }
  std::span<const std::int32_t> of(std::int64_t list) const {
    const auto l = static_cast<std::size_t>(list);
    return {item.data() + start[l], item.data() + start[l + 1]};
  }
  /// Ends the current list at the last item stored.
  void close_list() { start.push_back(static_cast<std::int64_t>(item.size())); }
};

/// For lists of items in [0, item_count): the numbers of the lists that contain each item, in
/// increasing order.
Lists make_transposed(const Lists& lists, std::int64_t item_count);

/// The stage by which a structure is made that the host and each device implement.
class StructureStages {
 public:
  virtual ~StructureStages() = default;

  /// The lowest item of the connected component of each item; the items of a list are connected.
  virtual std::vector<std::int32_t> lowest_connected(const Lists& lists,
                                                     std::int64_t item_count) = 0;
};

/// On one thread of the host.
class HostStages final : public StructureStages {
 public:
  std::vector<std::int32_t> lowest_connected(const Lists& lists, std::int64_t item_count) override;
};

/// Number of the connected component of each item; components are sorted by their lowest items.
std::vector<std::int32_t> components_of(const Lists& lists,
                                        std::int64_t item_count,
                                        StructureStages& stages);

/// Contacts sorted by (island, color, contact).
struct ContactOrder {
  std::vector<std::int32_t> contact_of_slot;  ///< [contacts]
  std::vector<std::int64_t> island_start;     ///< [islands + 1]: first slot of each island
  std::vector<std::int64_t> island_colors;    ///< [islands + 1]: its first entry of color_start
  std::vector<std::int64_t> color_start;      ///< for each island in turn: the first slot of each
                                              ///< of its colors, then the end of its slots
};

/// @param groups  groups of each contact; contacts that share one get different colors
/// @param island  number of the island of each contact; 0 to islands - 1, all in use
ContactOrder make_contact_order(const Lists& groups, std::span<const std::int32_t> island);

}  // namespace tetwarp

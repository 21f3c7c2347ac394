/// @file islands.hpp
/// Connected components of contacts and the order in which contacts are swept.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace tetwarp {

/// Lists of int32 of varying length, one after the other.
struct Lists {
  std::vector<std::int64_t> start = {0};  ///< [lists + 1]
  std::vector<std::int32_t> item;

  std::int64_t size() const { return static_cast<std::int64_t>(start.size()) - 1; }
  std::span<const std::int32_t> of(std::int64_t list) const {
    const auto l = static_cast<std::size_t>(list);
    return {item.data() + start[l], item.data() + start[l + 1]};
  }
  void close_list() { start.push_back(static_cast<std::int64_t>(item.size())); }
};

/// For lists of items in [0, item_count): the lists of each item, rising.
Lists make_transposed(const Lists& lists, std::int64_t item_count);

/// The two stages that a structure takes, wherever they run.
class StructureStages {
 public:
  virtual ~StructureStages() = default;

  /// The lowest item of the connected component of each item; two items are connected when they
  /// stand in a common list.
  virtual std::vector<std::int32_t> lowest_connected(const Lists& lists,
                                                     std::int64_t item_count) = 0;

  /// The color of each contact: greedy in their order, none twice in a group.
  /// @param groups   of each contact
  /// @param members  of each group: contacts, rising
  virtual std::vector<std::int32_t> colors_of(const Lists& groups, const Lists& members) = 0;
};

/// On one thread of the host.
class HostStages final : public StructureStages {
 public:
  std::vector<std::int32_t> lowest_connected(const Lists& lists, std::int64_t item_count) override;
  std::vector<std::int32_t> colors_of(const Lists& groups, const Lists& members) override;
};

/// Number of the connected component of each item, components numbered by their lowest item.
std::vector<std::int32_t> components_of(const Lists& lists,
                                        std::int64_t item_count,
                                        StructureStages& stages);

/// Contacts sorted by (island, color, contact).
struct ContactOrder {
  std::vector<std::int32_t> contact_of_slot;  ///< [contacts]
  std::vector<std::int64_t> island_start;     ///< [islands + 1], slots
  std::vector<std::int64_t> island_colors;    ///< [islands + 1], where in color_start
  std::vector<std::int64_t> color_start;      ///< per island: first slot of each color, then end
};

/// @param groups  of each contact: what it must not share with another contact of its color
/// @param island  of each contact, from 0 without holes
ContactOrder make_contact_order(const Lists& groups,
                                std::span<const std::int32_t> island,
                                StructureStages& stages);

}  // namespace tetwarp

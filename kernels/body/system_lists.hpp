/// @file system_lists.hpp
/// The sparse system of a step: its rows, the places of its 3x3 blocks, and lists of what is added
/// to each block.
///
/// Rows are the blocks of the model in another order: first blocks with unknowns, island after
/// island, then prescribed ones. Columns of a row ascend, so columns of prescribed blocks are last.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// Segments of items: those of segment i are item[start[i]] to item[start[i + 1] - 1]. An empty
/// `start` means that no segment has items.
struct ItemLists {
  View<const std::int32_t> start;
  View<const std::uint32_t> item;

  TETWARP_HD std::int64_t begin(std::int64_t i) const { return start.size == 0 ? 0 : start[i]; }
  TETWARP_HD std::int64_t end(std::int64_t i) const { return start.size == 0 ? 0 : start[i + 1]; }
  TETWARP_HD bool is_empty(std::int64_t i) const { return begin(i) == end(i); }
};

/// Items are element * slots^2 + slot of the row * slots + slot of the column in `blocks`, and
/// element * slots + slot in `rows`; slots is 4 for tetrahedra, 2 for edges, 8 for springs.
struct ElementLists {
  ItemLists blocks;  ///< of entries of SystemRows::upper
  ItemLists rows;
};

/// A block on or above the diagonal. Its mirror image is its transpose.
struct UpperBlock {
  std::int32_t place, mirror;  ///< of the block and its mirror image in the values
  std::int32_t scalar;         ///< entry of the constant multiples of 1, or -1
  std::int32_t rigid;          ///< 2 b or 2 b + 1: mass or inertia of rigid body b is added; or -1
};

struct SystemRows {
  std::int32_t count = 0, unknown_count = 0;
  View<const std::int32_t> block_of;  ///< [rows] block of the model
  View<const std::int32_t> start;     ///< [rows + 1] places of the row's blocks
  View<const std::int32_t>
      free_end;                     ///< [rows] place of the first block whose column is prescribed
  View<const std::int32_t> column;  ///< [places] row number
  View<const std::int32_t> diagonal;  ///< [rows] place
  View<const std::uint8_t> pair;      ///< [rows] 1: first, 2: second row of a rigid body, else 0
  View<const UpperBlock> upper;
  ElementLists tets, edges, springs;
  View<const std::int32_t> scalar_start;  ///< [nodes + 1] entries of each node
};

}  // namespace tetwarp

/// @file item_cells.hpp
/// Stage "item_cells" of collision detection: which cells of the grids an item's box covers.
///
/// Items of similar size share a uniform grid. An item is entered in the grid of its size and, to
/// meet larger items, in all coarser grids. The number of a cell has few bits: it is exact where
/// the grids have few cells, else a hash that several cells may share.
#pragma once
#include <cstdint>

#include "kernels/base/key_value.hpp"
#include "kernels/collide/item_box.hpp"

namespace tetwarp {

struct GridLevel {
  double per_cell;           ///< 1 / edge of a cell [1/m]
  std::uint32_t stride[3];   ///< of the cell's number along each axis
  std::uint32_t first_cell;  ///< number of the cell at the origin
};

struct GridPlan {
  double origin[3];  ///< lowest corner of all boxes
  std::int32_t level_count;
  std::int32_t key_bits, key_shift;  ///< bits of a cell's number; how many of 32 bits are dropped
  std::uint8_t level_of_size[item_sizes];  ///< ascending from the finest, 0
  GridLevel levels[item_sizes];

  /// Position of a cell along an axis: monotone in x, so that the cell of a box's corner is among
  /// the cells of the box. @pre x is not below the origin
  TETWARP_HD std::int64_t cell_along(const GridLevel& level, int axis, double x) const {
    return static_cast<std::int64_t>((x - origin[axis]) * level.per_cell);
  }
  TETWARP_HD std::uint32_t key_of(const GridLevel& level,
                                  std::int64_t i,
                                  std::int64_t j,
                                  std::int64_t k) const {
    const std::uint32_t sum = level.first_cell + static_cast<std::uint32_t>(i) * level.stride[0] +
                              static_cast<std::uint32_t>(j) * level.stride[1] +
                              static_cast<std::uint32_t>(k) * level.stride[2];
    return sum >> key_shift;
  }
};

/// One index = one item. Appends its entries, those of its own grid first. The key of an entry is
/// the cell, its value the item, and its flag is set where the item is smaller than those of the
/// grid.
struct ItemCellsOp {
  const GridPlan* plan;
  View<const Box> boxes;
  View<const std::int8_t> sizes;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    if (sizes[i] == skipped_item) return;
    const Box box = boxes[i];
    const int own = plan->level_of_size[sizes[i]];
    for (int l = own; l < plan->level_count; ++l) {
      const GridLevel& level = plan->levels[l];
      std::int64_t low[3], high[3];
      for (int a = 0; a < 3; ++a) {
        low[a] = plan->cell_along(level, a, box.low[a]);
        high[a] = plan->cell_along(level, a, box.high[a]);
      }
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        for (std::int64_t y = low[1]; y <= high[1]; ++y) {
          for (std::int64_t x = low[0]; x <= high[0]; ++x) {
            emit(make_key_value(plan->key_of(level, x, y, z), i, l > own));
          }
        }
      }
    }
  }
};

}  // namespace tetwarp

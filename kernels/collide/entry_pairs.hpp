/// @file entry_pairs.hpp
/// Stage "entry_pairs" of collision detection: pairs of items whose boxes overlap, from the sorted
/// entries of the grids.
#pragma once
#include <cstdint>

#include "kernels/collide/item_cells.hpp"

namespace tetwarp {

/// Items a < b whose boxes overlap.
struct ItemPair {
  std::int32_t a, b;
};

/// One index = one entry. Appends its pairs with the entries after it in the same cell.
///
/// Two items share several cells. Their pair is kept in the cell that holds the lowest corner of
/// the intersection of their boxes, in the grid of the larger item: each pair once.
struct EntryPairsOp {
  CollideView scene;
  const GridPlan* plan;
  View<const KeyValue> entries;  ///< sorted by cell, then item
  View<const Box> boxes;
  View<const std::int8_t> sizes;

  template <class Emit>
  TETWARP_HD void operator()(std::int64_t i, Emit& emit) const {
    const KeyValue entry = entries[i];
    if (is_repeated(i)) return;
    const std::int64_t cell = key_of(entry);
    const std::int32_t a = value_of(entry);
    const std::int32_t body = scene.items[a].body;
    std::int64_t j = i + 1;
    if (scene.bodies[body].touches_itself == 0)
      j = end_of_body(i, cell, scene.bodies[body].item_end);
    if (j >= entries.size || key_of(entries[j]) != cell) return;
    const Box box = boxes[a];
    std::int32_t body_end = 0;  // first item after those of the body that was tested last
    bool is_allowed = false;
    std::int64_t tests = 0;
    for (; j < entries.size && key_of(entries[j]) == cell; ++j) {
      const KeyValue other = entries[j];
      const std::int32_t b = value_of(other);
      if (b >= body_end) {
        const std::int32_t other_body = scene.items[b].body;
        body_end = scene.bodies[other_body].item_end;
        is_allowed = scene.may_touch(body, other_body);
      }
      // A pair of two items that are smaller than those of this grid is found in a finer grid.
      if (!is_allowed || a == b || (flag_of(entry) && flag_of(other))) continue;
      ++tests;
      const Box& second = boxes[b];
      if (!overlap(box, second) || is_repeated(j) || !is_lowest_cell(cell, a, b, box, second)) {
        continue;
      }
      emit(ItemPair{a, b});
    }
    emit.tally(tests);
  }

 private:
  /// Whether the entry before this one is of the same item and has the same cell number.
  TETWARP_HD bool is_repeated(std::int64_t i) const {
    return i > 0 && ((entries[i] ^ entries[i - 1]) & ~KeyValue{flag_bit}) == 0;
  }
  /// First entry after i with another cell number, or of an item from item_end on.
  TETWARP_HD std::int64_t end_of_body(std::int64_t i,
                                      std::int64_t cell,
                                      std::int32_t item_end) const {
    const auto is_own = [&](std::int64_t k) {
      return k < entries.size && key_of(entries[k]) == cell && value_of(entries[k]) < item_end;
    };
    std::int64_t low = i, step = 1;
    while (is_own(low + step)) low += step, step *= 2;
    for (; step > 1; step /= 2) {
      if (is_own(low + step / 2)) low += step / 2;
    }
    return low + 1;
  }
  TETWARP_HD bool is_lowest_cell(std::int64_t cell,
                                 std::int32_t a,
                                 std::int32_t b,
                                 const Box& first,
                                 const Box& second) const {
    const int level_a = plan->level_of_size[sizes[a]], level_b = plan->level_of_size[sizes[b]];
    const GridLevel& level = plan->levels[max_of(level_a, level_b)];
    std::int64_t at[3];
    for (int k = 0; k < 3; ++k) {
      at[k] = plan->cell_along(level, k, max_of(first.low[k], second.low[k]));
    }
    return plan->key_of(level, at[0], at[1], at[2]) == cell;
  }
};

}  // namespace tetwarp

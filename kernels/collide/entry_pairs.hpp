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

/// One index = one entry. Appends its pairs with the entries after it in the same cell, and with
/// those before it that are of items smaller than those of the grid. Such items do not look for
/// pairs in this cell: a large item may have thousands of them around it.
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
    if (flag_of(entry) || is_repeated(i)) return;
    const std::int64_t cell = key_of(entry);
    const std::int32_t body = scene.items[value_of(entry)].body;
    std::int64_t after = i + 1;
    if (scene.bodies[body].touches_itself == 0) {
      after = end_of_body(i, cell, scene.bodies[body].item_end);
    }
    std::int64_t tests = compare(i, after, entries.size, false, emit);
    if (plan->level_of_size[sizes[value_of(entry)]] > 0) {
      tests += compare(i, begin_of_cell(i, cell), i, true, emit);
    }
    emit.tally(tests);
  }

 private:
  /// Compares entry i with entries [begin, end) of the same cell. @returns the tests
  /// @param smaller  only with those of items smaller than those of the grid
  template <class Emit>
  TETWARP_HD std::int64_t compare(
      std::int64_t i, std::int64_t begin, std::int64_t end, bool smaller, Emit& emit) const {
    const std::int64_t cell = key_of(entries[i]);
    const std::int32_t a = value_of(entries[i]), body = scene.items[a].body;
    const Box box = boxes[a];
    std::int32_t body_end = 0;  // first item after those of the body that was tested last
    bool is_allowed = false;
    std::int64_t tests = 0;
    for (std::int64_t j = begin; j < end && key_of(entries[j]) == cell; ++j) {
      const KeyValue other = entries[j];
      if (smaller && !flag_of(other)) continue;
      const std::int32_t b = value_of(other);
      if (b >= body_end) {
        const std::int32_t other_body = scene.items[b].body;
        body_end = scene.bodies[other_body].item_end;
        is_allowed = scene.may_touch(min_of(body, other_body), max_of(body, other_body));
      }
      if (!is_allowed || a == b) continue;
      ++tests;
      const Box& second = boxes[b];
      if (!overlap(box, second) || is_repeated(j) || !is_lowest_cell(cell, a, b, box, second)) {
        continue;
      }
      emit(ItemPair{min_of(a, b), max_of(a, b)});
    }
    return tests;
  }
  /// The first entry of the cell.
  TETWARP_HD std::int64_t begin_of_cell(std::int64_t i, std::int64_t cell) const {
    const auto is_own = [&](std::int64_t k) { return k >= 0 && key_of(entries[k]) == cell; };
    std::int64_t low = i, step = 1;
    while (is_own(low - step)) low -= step, step *= 2;
    for (; step > 1; step /= 2) {
      if (is_own(low - step / 2)) low -= step / 2;
    }
    return low;
  }
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

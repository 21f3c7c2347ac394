/// @file cell_merge.hpp
/// Stage "cull" of a step that updates the previous one: merges the pairs of tetrahedra that have
/// not moved with the new pairs of those that have, and marks the cells that this changes.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_pairs.hpp"

namespace tetwarp {

/// One index = one cell; any order. A cell is touched if a moved tetrahedron has a pair with it in
/// the previous step or in this one.
struct CellTouchOp {
  PairList before;
  PairList fresh;
  View<const std::uint8_t> moved;
  View<std::uint8_t> touched;
  View<std::int64_t> pair_counts;
  View<std::int64_t> touched_count;

  TETWARP_HD void operator()(std::int64_t cell) const {
    const std::int64_t end = end_of_cell(before, cell);
    std::int64_t staying = 0, leaving = 0;
    for (std::int64_t p = before.ranges[cell].begin; p < end; ++p) {
      const std::int64_t leaves = moved[tet_of(before.pairs[p])];
      leaving += leaves;
      staying += 1 - leaves;
    }
    const std::int64_t coming = end_of_cell(fresh, cell) - fresh.ranges[cell].begin;
    pair_counts[cell] = staying + coming;
    touched[cell] = leaving + coming > 0;
    if (leaving + coming > 0) atomic_add(&touched_count[0], 1);
  }
};

/// One index = one cell; any order. Marks cells that are touched in at least one of two steps.
struct CellEverTouchedOp {
  View<const std::uint8_t> now;
  View<const std::uint8_t> before;
  View<std::uint8_t> touched;

  TETWARP_HD void operator()(std::int64_t cell) const { touched[cell] = now[cell] | before[cell]; }
};

/// One index = one cell, or one past the last; any order. Merges the cell's pairs of two lists,
/// which are sorted by tetrahedron.
struct CellMergeOp {
  PairList before;
  PairList fresh;
  View<const std::uint8_t> moved;
  View<const std::int64_t> pair_offsets;
  View<CellPair> pairs;
  View<std::int64_t> pair_count;
  View<CellRange> ranges;

  TETWARP_HD void operator()(std::int64_t cell) const {
    const std::int64_t begin = pair_offsets[cell];
    if (cell + 1 == ranges.size) {
      pair_count[0] = begin;
      ranges[cell] = range_of(begin, begin);
      return;
    }
    const std::int64_t old_end = end_of_cell(before, cell), new_end = end_of_cell(fresh, cell);
    std::int64_t next = fresh.ranges[cell].begin, at = begin, accepted_end = -1;
    const auto append = [&](CellPair pair) {
      if (at < pairs.size) pairs[at] = pair;
      ++at;
      if (accepted_end < 0 && is_accepted(pair)) accepted_end = at;
    };
    for (std::int64_t p = before.ranges[cell].begin; p < old_end; ++p) {
      const CellPair pair = before.pairs[p];
      if (moved[tet_of(pair)] != 0) continue;
      for (; next < new_end && tet_of(fresh.pairs[next]) < tet_of(pair); ++next) {
        append(fresh.pairs[next]);
      }
      append(pair);
    }
    for (; next < new_end; ++next) append(fresh.pairs[next]);
    ranges[cell] = range_of(begin, accepted_end < 0 ? at : accepted_end);
  }

  TETWARP_HD CellRange range_of(std::int64_t begin, std::int64_t end) const {
    return {static_cast<std::uint32_t>(min_of(begin, pairs.size)),
            static_cast<std::uint32_t>(min_of(end, pairs.size))};
  }
};

/// Replaces the pairs of moved tetrahedra by their new ones. The result is the list that
/// cell_pairs() would make from all tetrahedra.
///
/// @param exec           where to run
/// @param before         pairs of the previous step
/// @param fresh          pairs of the moved tetrahedra in this step
/// @param moved          from tet_moved, shape [tet_count]
/// @param pairs          out; pairs beyond its size are dropped
/// @param pair_count     out, number of pairs including dropped ones, shape [1]
/// @param pair_offsets   scratch, shape [cell_count + 1]
/// @param ranges         out, shape [cell_count + 1]
/// @param touched        out, 1 for touched cells, see CellTouchOp, shape [cell_count]
/// @param touched_count  the number of touched cells is added to it, shape [1]
/// @pre both lists are sorted by cell, then tetrahedron; `before` has the pairs of all tetrahedra
///
/// Determinism: same bits for the same lists. Cost: 3 times 8 bytes per pair.
/// Source: ours; Gascon et al. 2013 rasterize everything in every frame.
template <class Exec>
void cell_merge(Exec& exec,
                const PairList& before,
                const PairList& fresh,
                View<const std::uint8_t> moved,
                View<CellPair> pairs,
                View<std::int64_t> pair_count,
                View<std::int64_t> pair_offsets,
                View<CellRange> ranges,
                View<std::uint8_t> touched,
                View<std::int64_t> touched_count) {
  exec.for_each("warp/cull", touched.size,
                CellTouchOp{before, fresh, moved, touched, pair_offsets, touched_count});
  exec.exclusive_scan("warp/cull", pair_offsets);
  exec.for_each("warp/cull", ranges.size,
                CellMergeOp{before, fresh, moved, pair_offsets, pairs, pair_count, ranges});
}

}  // namespace tetwarp

/// @file cell_merge.hpp
/// Stage "cull" of a step that updates the one before: the pairs that have stayed and the fresh
/// ones, and which cells they change.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_pairs.hpp"

namespace tetwarp {

/// One index = one cell; any order. A cell is touched when a tetrahedron that has moved was or is
/// there.
struct CellTouchBody {
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

/// One index = one cell; any order. Touched in either of two steps.
struct CellEverTouchedBody {
  View<const std::uint8_t> now;
  View<const std::uint8_t> before;
  View<std::uint8_t> touched;

  TETWARP_HD void operator()(std::int64_t cell) const { touched[cell] = now[cell] | before[cell]; }
};

/// One index = one cell or the end behind the last; any order. Merges two runs that ascend by
/// tetrahedron.
struct CellMergeBody {
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
    std::int64_t next = fresh.ranges[cell].begin, at = begin, settled = -1;
    const auto append = [&](CellPair pair) {
      if (at < pairs.size) pairs[at] = pair;
      ++at;
      if (settled < 0 && is_accepted(pair)) settled = at;
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
    ranges[cell] = range_of(begin, settled < 0 ? at : settled);
  }

  TETWARP_HD CellRange range_of(std::int64_t begin, std::int64_t end) const {
    return {static_cast<std::uint32_t>(min_of(begin, pairs.size)),
            static_cast<std::uint32_t>(min_of(end, pairs.size))};
  }
};

/// Replaces the pairs of moved tetrahedra by fresh ones: the list that cell_pairs() would make of
/// all.
///
/// @param exec           where to run
/// @param before         of the step before
/// @param fresh          of the moved tetrahedra in this step
/// @param moved          from tet_moved, shape [tet_count]
/// @param pairs          out; pairs that it has no room for are left out
/// @param pair_count     out, how many there are, those left out included, shape [1]
/// @param pair_offsets   scratch, shape [cell_count + 1]
/// @param ranges         out, shape [cell_count + 1]
/// @param touched        out, 1 where the pairs of a cell had or have a moved tetrahedron, shape
///                       [cell_count]
/// @param touched_count  such cells are added to it, shape [1]
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
                CellTouchBody{before, fresh, moved, touched, pair_offsets, touched_count});
  exec.exclusive_scan("warp/cull", pair_offsets);
  exec.for_each("warp/cull", ranges.size,
                CellMergeBody{before, fresh, moved, pair_offsets, pairs, pair_count, ranges});
}

}  // namespace tetwarp

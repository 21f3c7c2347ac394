/// @file cell_pairs.hpp
/// Stage "cull" of the warp, second half: sorts the pairs that were not rejected by cell, then
/// tetrahedron.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_cull.hpp"

namespace tetwarp {

/// The pairs of one cell that the raster needs: [begin, end) of the sorted list. It ends after the
/// first accepted pair, whose tetrahedron owns all voxels that no lower one does.
struct CellRange {
  std::uint32_t begin;
  std::uint32_t end;
};

/// Sorted pairs and the range of every cell; after the last cell's an empty range at the end of the
/// list.
struct PairList {
  View<const CellPair> pairs;
  View<const CellRange> ranges;  ///< shape [cell_count + 1]
};

/// One past the last pair of a cell, including those after the first accepted one.
TETWARP_HD std::int64_t end_of_cell(const PairList& list, std::int64_t cell) {
  return list.ranges[cell + 1].begin;
}

/// Position, among the first `count` sorted pairs, of the first whose cell is not below `cell`.
TETWARP_HD std::int64_t lower_bound_of_cell(View<const CellPair> pairs,
                                            std::int64_t count,
                                            std::int64_t cell) {
  std::int64_t low = 0, high = count;
  while (low < high) {
    const std::int64_t middle = (low + high) / 2;
    if (cell_of(pairs[middle]) < cell) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

/// One index = one cell; any order.
struct CellRangeOp {
  View<const CellPair> pairs;
  View<const std::int64_t> pair_count;
  View<CellRange> ranges;
  View<std::int64_t> accepted_count;

  TETWARP_HD void operator()(std::int64_t cell) const {
    set_range(cell, lower_bound_of_cell(pairs, count(), cell));
  }

  TETWARP_HD std::int64_t count() const { return min_of(pair_count[0], pairs.size); }

  /// Sets the range of a cell whose pairs start at `begin`.
  /// @returns start of the next cell's pairs
  TETWARP_HD std::int64_t set_range(std::int64_t cell, std::int64_t begin) const {
    const std::int64_t past = count();
    std::int64_t end = begin, accepted = 0, accepted_end = -1;
    for (; end < past && cell_of(pairs[end]) == cell; ++end) {
      if (!is_accepted(pairs[end])) continue;
      ++accepted;
      if (accepted_end < 0) accepted_end = end + 1;
    }
    ranges[cell] = {static_cast<std::uint32_t>(begin),
                    static_cast<std::uint32_t>(accepted_end < 0 ? end : accepted_end)};
    if (accepted > 0) atomic_add(&accepted_count[0], accepted);
    return end;
  }
};

/// Sets the range of every cell. The CPU's executor has a faster overload
/// (host/warp/cpu/cell_cull_cpu.hpp).
template <class Exec>
void cell_ranges(Exec& exec, const CellRangeOp& op) {
  exec.for_each("warp/cull", op.ranges.size, op);
}

/// Compacts and sorts the pairs and finds the range of every cell.
///
/// @param exec            where to run
/// @param candidates      from cell_cull
/// @param candidate_count number of candidates, shape [1], may exceed the capacity of `candidates`
/// @param frame           the output
/// @param pairs           out, pairs that are not rejected, sorted by cell, then tetrahedron
/// @param pair_count      out, number of these pairs, shape [1]
/// @param ranges          out, shape [cell_count], or [cell_count + 1] for a PairList
/// @param accepted_count  the number of accepted pairs is added to it, shape [1]
///
/// Determinism: same bits for the same candidates. Cost: a stable radix sort of 8-byte words.
/// Source: cell-centric order is ours; Gascon et al. 2013 rasterize tetrahedron by tetrahedron.
template <class Exec>
void cell_pairs(Exec& exec,
                View<const CellPair> candidates,
                View<const std::int64_t> candidate_count,
                const OutputFrame& frame,
                View<CellPair> pairs,
                View<std::int64_t> pair_count,
                View<CellRange> ranges,
                View<std::int64_t> accepted_count) {
  int cell_bits = 1;
  while (frame.cell_count() >> cell_bits != 0) ++cell_bits;
  exec.select_valid("warp/cull", candidates, candidate_count, pairs, pair_count);
  exec.sort_pairs("warp/cull", pairs, pair_count, cell_bits);
  cell_ranges(exec, CellRangeOp{pairs, pair_count, ranges, accepted_count});
}

}  // namespace tetwarp

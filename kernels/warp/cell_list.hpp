/// @file cell_list.hpp
/// Stage "cull" of the warp on a device: the sorted pairs of every cell by counting. Pairs that are
/// not rejected are counted per cell, the counts summed, the pairs placed in their cell's part of
/// the list, and each part sorted by tetrahedron. The list is that of cell_pairs() and
/// cell_merge().
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/grouped_sums.hpp"
#include "kernels/base/lower_to.hpp"
#include "kernels/warp/cell_cull.hpp"
#include "kernels/warp/cell_pairs.hpp"

namespace tetwarp {

/// A counter in several places, summed at the end of a step, so that few threads add to one
/// address. Size 0: not counted.
using SpreadCounter = View<std::int64_t>;

TETWARP_HD void add_to(const SpreadCounter& counter, std::int64_t index, std::int64_t value) {
  if (counter.size > 0) atomic_add(&counter[index % counter.size], value);
}

/// One item = one candidate pair; any order. Culls, and counts the pairs of each cell.
template <class Verdict>
struct CellCountOp {
  static constexpr int resident_blocks = 4;  ///< leaves 64 registers per thread: no spills
  CellCullOp<Verdict> cull;
  View<std::uint32_t> places;       ///< out, of pairs that are not rejected: number in their cell
  View<std::uint32_t> cell_counts;  ///< in and out

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    const CellPair pair = cull(t, local, item);
    if (pair != rejected_pair) places[item] = atomic_next(&cell_counts[cell_of(pair)]);
  }
};

/// What an update keeps of the step before, per cell.
struct StayingPairs {
  PairList before;
  View<const std::uint8_t> moved;  ///< per tetrahedron; size 0: not an update, nothing stays
  View<std::uint32_t> counts;      ///< out of CellStayOp, twice the number of pairs that stay,
                                   ///< plus 1 where one leaves; shape [cell_count]

  TETWARP_HD bool is_update() const { return moved.size > 0; }
  TETWARP_HD std::int64_t count(std::int64_t cell) const {
    return is_update() ? counts[cell] / 2 : 0;
  }
  TETWARP_HD bool leaves_one(std::int64_t cell) const {
    return is_update() && counts[cell] % 2 != 0;
  }
};

/// One index = one cell; any order. Counts the pairs of the step before whose tetrahedron has not
/// moved.
struct CellStayOp {
  StayingPairs staying;
  View<std::uint32_t> cell_counts;  ///< out

  TETWARP_HD void operator()(std::int64_t cell) const {
    const PairList& before = staying.before;
    const std::int64_t begin = before.ranges[cell].begin, end = end_of_cell(before, cell);
    std::uint32_t count = 0;
    for (std::int64_t p = begin; p < end; ++p) {
      count += staying.moved[tet_of(before.pairs[p])] == 0 ? 1u : 0u;
    }
    cell_counts[cell] = count;
    staying.counts[cell] = 2 * count + (count < end - begin ? 1u : 0u);
  }
};

/// One index = one cell; the count that is summed. The last thread stores the number of all pairs.
struct CellSumOp {
  View<const std::uint32_t> cell_counts;
  View<std::int64_t> pair_count;

  TETWARP_HD std::int64_t operator()(std::int64_t cell) const { return cell_counts[cell]; }
  TETWARP_HD void finish(std::int64_t total, int k) const {
    if (k == 0) pair_count[0] = total;
  }
};

/// The list that is made, and what is counted of it.
struct CellListResult {
  View<CellPair> pairs;          ///< out
  View<CellRange> ranges;        ///< out, shape [cell_count + 1]
  View<std::uint8_t> touched;    ///< out in an update: 1 where a pair left or came
  SpreadCounter pair_count;      ///< pairs that do not stay are added
  SpreadCounter accepted_count;  ///< the accepted ones of these are added
  SpreadCounter touched_count;   ///< touched cells are added
};

/// One index = one candidate pair, and one cell or one past the last; any order. Copies pairs to
/// the part of their cell in `placed`, those that stay first, and sets the cell's range as if no
/// pair were accepted.
struct CellScatterOp {
  GroupedSums candidate_sums;
  View<const CellPair> candidates;
  View<const std::uint32_t> places;
  StayingPairs staying;
  GroupedSums cells;
  View<CellPair> placed;  ///< out; pairs beyond its size are dropped
  CellListResult result;

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i < min_of(candidate_sums.total(), candidates.size) && candidates[i] != rejected_pair) {
      put(cells[cell_of(candidates[i])] + places[i], candidates[i]);
    }
    if (i < cells.size) set_cell(i);
  }

  TETWARP_HD void put(std::int64_t at, CellPair pair) const {
    if (at < placed.size) placed[at] = pair;
  }

  TETWARP_HD void set_cell(std::int64_t cell) const {
    const std::int64_t begin = min_of(cells[cell], placed.size);
    const bool is_cell = cell + 1 < cells.size;
    const std::int64_t end = is_cell ? min_of(cells[cell + 1], placed.size) : begin;
    result.ranges[cell] = {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    if (!is_cell) return;
    const std::int64_t come = max_of(end - begin - staying.count(cell), std::int64_t{0});
    if (come > 0) add_to(result.pair_count, cell, come);
    if (!staying.is_update()) return;
    copy_staying(cell);
    const bool is_touched = come > 0 || staying.leaves_one(cell);
    result.touched[cell] = is_touched;
    if (is_touched) add_to(result.touched_count, cell, 1);
  }

  TETWARP_HD void copy_staying(std::int64_t cell) const {
    const std::int64_t end = end_of_cell(staying.before, cell);
    std::int64_t at = cells[cell];
    for (std::int64_t p = staying.before.ranges[cell].begin; p < end; ++p) {
      const CellPair pair = staying.before.pairs[p];
      if (staying.moved[tet_of(pair)] == 0) put(at++, pair);
    }
  }
};

/// One index = one pair; any order. Sorts the pairs of each cell by tetrahedron, as many steps per
/// pair as its cell has pairs, and ends the cell's range after its first accepted pair.
struct CellOrderOp {
  GroupedSums cells;
  View<const CellPair> placed;
  StayingPairs staying;
  CellListResult result;

  TETWARP_HD void operator()(std::int64_t i) const {
    if (i >= min_of(cells.total(), placed.size)) return;
    const CellPair pair = placed[i];
    const std::int64_t cell = cell_of(pair), begin = cells[cell];
    const auto count = static_cast<int>(min_of(cells[cell + 1], placed.size) - begin);
    int lower = 0;  // 32 bits: half of the operations of the loop with 64
    for (int k = 0; k < count; ++k) lower += tet_of(placed[begin + k]) < tet_of(pair) ? 1 : 0;
    const std::int64_t at = begin + lower;
    result.pairs[at] = pair;
    if (!is_accepted(pair)) return;
    lower_to(&result.ranges[cell].end, static_cast<std::uint32_t>(at + 1));
    if (i - begin >= staying.count(cell)) add_to(result.accepted_count, cell, 1);
  }
};

/// Buffers and results of cell_list().
struct CellListMemory {
  View<CellPair> candidates;        ///< one per candidate pair
  View<std::uint32_t> places;       ///< as many
  View<std::uint32_t> cell_counts;  ///< shape [cell_count]; zero unless it is an update
  GroupedSums cells;                ///< of cell_count counts
  View<CellPair> placed;            ///< as many as pairs
};

/// The sorted list of pairs and the range of every cell.
///
/// @param exec       where to run: a device
/// @param candidate_sums  sums of the numbers of candidate pairs of each tetrahedron
/// @param cull       all but `pairs`
/// @param memory     scratch
/// @param staying    of the step before, in an update
/// @param result     out
/// @param list_size  out, number of pairs including those that found no room, shape [1]
///
/// Determinism: same bits for the same setups; places depend on the order of threads, the sorted
/// list does not. Cost: five launches, four without an update; 40 bytes per pair.
/// Source: counting sort; ours.
template <class Exec, class Verdict>
void cell_list(Exec& exec,
               const GroupedSums& candidate_sums,
               CellCullOp<Verdict> cull,
               const CellListMemory& memory,
               const StayingPairs& staying,
               const CellListResult& result,
               View<std::int64_t> list_size) {
  const std::int64_t cells = memory.cells.size - 1;
  if (staying.is_update()) {
    exec.for_each("warp/cull", cells, CellStayOp{staying, memory.cell_counts});
  }
  cull.pairs = memory.candidates;
  exec.for_each_item("warp/cull", candidate_sums, memory.candidates.size,
                     CellCountOp<Verdict>{cull, memory.places, memory.cell_counts});
  exec.grouped_scan("warp/cull", cells, CellSumOp{memory.cell_counts, list_size}, memory.cells);
  exec.for_each("warp/cull", max_of(memory.candidates.size, cells + 1),
                CellScatterOp{candidate_sums, memory.candidates, memory.places, staying,
                              memory.cells, memory.placed, result});
  exec.for_each("warp/cull", memory.placed.size,
                CellOrderOp{memory.cells, memory.placed, staying, result});
}

}  // namespace tetwarp

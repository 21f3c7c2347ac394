/// @file cell_cull.hpp
/// Stage "cull" of the warp: rejects, accepts or keeps each (tetrahedron, cell) pair by the masks
/// of the cell's eight corners.
#pragma once
#include <cstdint>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/corner_mask.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Which verdicts are used. Without its verdict a pair is kept, and its voxels are tested.
struct CullSwitches {
  bool reject = true;
  bool accept = true;
};

/// One item = one candidate pair; any order. Cells of a tetrahedron are numbered i fastest.
struct CellCullBody {
  View<const TetSetup> setups;
  View<const std::int64_t> corner_offsets;
  View<const std::uint16_t> masks;
  CullSwitches switches;
  OutputFrame frame;
  View<CellPair> pairs;

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    const TetSetup& tet = setups[t];
    const int nx = last_cell(tet, 0) - first_cell(tet, 0) + 1;
    const int ny = last_cell(tet, 1) - first_cell(tet, 1) + 1;
    const std::int64_t row = local / nx;
    const std::int64_t line = nx + 1;
    const std::int64_t slice = line * (ny + 1);
    const std::int64_t first =
        corner_offsets[t] + local % nx + (row % ny) * line + (row / ny) * slice;
    // Without masks a pair is kept: small tetrahedra have none, and if their buffer was too small
    // the step is repeated.
    unsigned all = 0;
    const bool has_masks = corner_offsets[t] < corner_offsets[t + 1];
    if (has_masks && first + slice + line + 1 < masks.size) {
      all = ~0u;
      for (int corner = 0; corner < 8; ++corner) {
        all &= masks[first + (corner & 1) + (corner >> 1 & 1) * line + (corner >> 2) * slice];
      }
    }
    const std::int64_t cell = frame.cell_index(static_cast<int>(first_cell(tet, 0) + local % nx),
                                               static_cast<int>(first_cell(tet, 1) + row % ny),
                                               static_cast<int>(first_cell(tet, 2) + row / ny));
    const bool accepted = switches.accept && (all & inside_bits) == inside_bits;
    const bool rejected = switches.reject && (all & outside_bits) != 0;
    pairs[item] = rejected ? rejected_pair : make_pair(cell, t, accepted);
  }
};

/// Rejects, accepts or keeps every candidate pair.
///
/// @param exec            where to run
/// @param setups          from tet_setup, shape [tet_count]
/// @param corner_offsets  first corner of each tetrahedron, shape [tet_count + 1]
/// @param masks           from corner_mask
/// @param pair_offsets    first candidate pair of each tetrahedron, shape [tet_count + 1]
/// @param switches        which verdicts are used
/// @param frame           the output
/// @param pairs           out, one per candidate pair, `rejected_pair` where no voxel is inside
/// @pre pairs.size is at least the number of candidate pairs, or the step is repeated with more
///
/// Determinism: as corner_mask(). Cost: 16 bytes read, 8 written per pair.
/// Source: Gascon et al. 2013, section 4 (rejection); acceptance is ours.
template <class Exec>
void cell_cull(Exec& exec,
               View<const TetSetup> setups,
               View<const std::int64_t> corner_offsets,
               View<const std::uint16_t> masks,
               View<const std::int64_t> pair_offsets,
               CullSwitches switches,
               const OutputFrame& frame,
               View<CellPair> pairs) {
  exec.reject_all("warp/cull", pairs);
  exec.for_each_item("warp/cull", pair_offsets, pairs.size,
                     CellCullBody{setups, corner_offsets, masks, switches, frame, pairs});
}

/// Stages "mask" and "cull" together; parameters as cell_cull(). The CPU's executor has a faster
/// overload (host/warp/cpu/cell_cull_cpu.hpp).
/// @param masks  scratch, as many as there are corners
template <class Exec>
void cell_verdicts(Exec& exec,
                   View<const TetSetup> setups,
                   View<const std::int64_t> corner_offsets,
                   View<std::uint16_t> masks,
                   View<const std::int64_t> pair_offsets,
                   CullSwitches switches,
                   const OutputFrame& frame,
                   View<CellPair> pairs) {
  corner_mask(exec, setups, corner_offsets, masks);
  cell_cull(exec, setups, corner_offsets, masks, pair_offsets, switches, frame, pairs);
}

}  // namespace tetwarp

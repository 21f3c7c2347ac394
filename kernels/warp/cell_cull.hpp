/// @file cell_cull.hpp
/// Stage "cull" of the warp: rejects, accepts or keeps each (tetrahedron, cell) pair.
#pragma once
#include <cstdint>

#include "kernels/base/cell_pair.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

enum class CellVerdict { rejected, accepted, partial };

/// Which verdicts are used. Without its verdict a pair is kept, and its voxels are tested.
struct CullSwitches {
  bool reject = true;
  bool accept = true;
};

/// Tetrahedra whose box touches fewer cells keep all their pairs: most of their cells would be kept
/// anyway, and testing the voxels of the others costs less than verdicts on all.
constexpr std::int64_t fewest_culled_cells = 27;

/// Compares a cell with the planes of a tetrahedron. Along the normal of a face, one corner of the
/// cell has the least and one the largest plane value: these two decide as all eight corners do.
struct PlaneVerdict {
  /// @param cell  of the tetrahedron's box [cell]
  TETWARP_HD CellVerdict operator()(const TetSetup& tet,
                                    std::int64_t,
                                    const std::int64_t* cell) const {
    double d[3], size = cell_edge * 3 + 1;
    for (int axis = 0; axis < 3; ++axis) {
      d[axis] = static_cast<double>(cell[axis] * cell_edge - tet.anchor[axis]);
      size += fabs(d[axis]);
    }
    bool is_inside = true;
    for (int face = 0; face < 4; ++face) {
      const double offset = tet.plane[3][face];
      const double value = tet.plane[0][face] * d[0] + tet.plane[1][face] * d[1] +
                           tet.plane[2][face] * d[2] + offset;
      double low = value, high = value;
      for (int axis = 0; axis < 3; ++axis) {
        const double change = tet.plane[axis][face] * cell_edge;
        low += min_of(change, 0.0);
        high += max_of(change, 0.0);
      }
      // 1000 times the rounding error of the lines above, fused or not.
      const double margin = (size + fabs(offset)) * 0x1p-40;
      if (high < -margin || low > tet.height[face] + margin) return CellVerdict::rejected;
      is_inside = is_inside && low > margin;
    }
    return is_inside ? CellVerdict::accepted : CellVerdict::partial;
  }
};

/// One item = one candidate pair; any order. Cells of a tetrahedron are numbered i fastest.
/// @tparam Verdict  PlaneVerdict, or MaskVerdict of corner_mask.hpp
template <class Verdict>
struct CellCullOp {
  View<const TetSetup> setups;
  Verdict verdict;
  CullSwitches switches;
  OutputFrame frame;
  View<CellPair> pairs;  ///< out, `rejected_pair` where no voxel is inside

  /// @returns the pair, which is also stored
  TETWARP_HD CellPair operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    const TetSetup& tet = setups[t];
    std::int64_t cell[3], box = 1;
    auto rest = static_cast<std::uint32_t>(local);  // pairs are numbered by 32 bits
    for (int axis = 0; axis < 3; ++axis) {
      const int first = first_cell(tet, axis);
      const auto count = static_cast<std::uint32_t>(last_cell(tet, axis) - first + 1);
      cell[axis] = first + static_cast<std::int64_t>(rest % count);
      rest /= count;
      box *= count;
    }
    const CellVerdict found =
        box < fewest_culled_cells ? CellVerdict::partial : verdict(tet, t, cell);
    if (switches.reject && found == CellVerdict::rejected) return pairs[item] = rejected_pair;
    const std::int64_t number = frame.cell_index(
        static_cast<int>(cell[0]), static_cast<int>(cell[1]), static_cast<int>(cell[2]));
    return pairs[item] = make_pair(number, t, switches.accept && found == CellVerdict::accepted);
  }
};

/// Rejects, accepts or keeps every candidate pair. With PlaneVerdict the CPU's executor has a
/// faster overload that rejects more pairs (host/warp/cpu/cell_cull_cpu.hpp); a device counts the
/// pairs of each cell in the same launch (cell_list.hpp).
///
/// Conservative: rounding neither rejects nor accepts wrongly, so culling never changes the output.
/// @param exec          where to run
/// @param setups        from tet_setup, shape [tet_count]
/// @param verdict       see CellCullOp
/// @param pair_offsets  first candidate pair of each tetrahedron, shape [tet_count + 1]
/// @param switches      which verdicts are used
/// @param frame         the output
/// @param pairs         out, one per candidate pair, `rejected_pair` where no voxel is inside
/// @pre pairs.size is at least the number of candidate pairs
///
/// Determinism: verdicts may differ between back ends within the margin of a plane; the output
/// cannot. Cost: 12 products (planes) or 16 bytes read (masks), 8 bytes written per pair.
/// Source: Gascon et al. 2013, section 4 (rejection by masks); two corners in place of eight and
/// acceptance are ours.
template <class Exec, class Verdict>
void cell_cull(Exec& exec,
               View<const TetSetup> setups,
               const Verdict& verdict,
               View<const std::int64_t> pair_offsets,
               CullSwitches switches,
               const OutputFrame& frame,
               View<CellPair> pairs) {
  exec.for_each_item("warp/cull", pair_offsets, pairs.size,
                     CellCullOp<Verdict>{setups, verdict, switches, frame, pairs});
}

}  // namespace tetwarp

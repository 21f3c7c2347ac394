/// @file corner_mask.hpp
/// Stage "mask" of the warp with SkipOptions::grid_point_masks: on which sides of the faces of a
/// tetrahedron the corners of a cell certainly lie, and what the masks of its eight corners say of
/// the cell.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/warp/cell_cull.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

// With b_f the barycentric coordinate of node f:
constexpr unsigned outside_bits =
    0x0ff;                               ///< bit 2f: certainly b_f < 0, bit 2f+1: certainly b_f > 1
constexpr unsigned inside_bits = 0xf00;  ///< bit 8+f: certainly b_f > 0

/// Mask of one corner at voxel (x, y, z) [frame].
TETWARP_HD std::uint16_t corner_mask_of(const TetSetup& tet,
                                        std::int64_t x,
                                        std::int64_t y,
                                        std::int64_t z) {
  const double dx = static_cast<double>(x - tet.anchor[0]);
  const double dy = static_cast<double>(y - tet.anchor[1]);
  const double dz = static_cast<double>(z - tet.anchor[2]);
  unsigned mask = 0;
  for (int face = 0; face < 4; ++face) {
    const double offset = tet.plane[3][face];
    const double value =
        tet.plane[0][face] * dx + tet.plane[1][face] * dy + tet.plane[2][face] * dz + offset;
    // 1000 times the rounding error of the line above, fused or not.
    const double margin = (fabs(dx) + fabs(dy) + fabs(dz) + fabs(offset) + 1) * 0x1p-40;
    mask |= unsigned(value < -margin) << (2 * face);
    mask |= unsigned(value > tet.height[face] + margin) << (2 * face + 1);
    mask |= unsigned(value > margin) << (8 + face);
  }
  return static_cast<std::uint16_t>(mask);
}

/// Corners of the cells that a tetrahedron's box touches, along one axis.
TETWARP_HD std::int64_t corners_along(const TetSetup& tet, int axis) {
  return last_cell(tet, axis) - first_cell(tet, axis) + 2;
}

/// Upper bound of the number of corners of tetrahedra that have `pairs` candidate pairs together: a
/// box of n >= fewest_culled_cells cells has at most 4 (n + 1) corners, those of a row.
constexpr std::int64_t most_corners(std::int64_t pairs) {
  return 5 * pairs;
}

/// One index = one tetrahedron: corners of the cells of its box; any order. None where it has fewer
/// than fewest_culled_cells candidate pairs.
/// @tparam Offsets  View<const std::int64_t> or GroupedSums
template <class Offsets>
struct CornerCountOp {
  View<const TetSetup> setups;
  Offsets pair_offsets;
  View<std::int64_t> counts;  ///< out

  TETWARP_HD std::int64_t operator()(std::int64_t t) const {
    counts[t] = 0;
    if (pair_offsets[t + 1] - pair_offsets[t] < fewest_culled_cells) return 0;
    counts[t] = 1;
    for (int axis = 0; axis < 3; ++axis) counts[t] *= corners_along(setups[t], axis);
    return counts[t];
  }
  TETWARP_HD void finish(std::int64_t, int) const {}
};

/// One item = one corner of a cell of one tetrahedron's box, numbered i fastest; any order.
struct CornerMaskOp {
  View<const TetSetup> setups;
  View<std::uint16_t> masks;

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    const TetSetup& tet = setups[t];
    const std::int64_t nx = corners_along(tet, 0), ny = corners_along(tet, 1);
    const std::int64_t row = local / nx;
    const std::int64_t x = first_cell(tet, 0) + local % nx;
    const std::int64_t y = first_cell(tet, 1) + row % ny;
    const std::int64_t z = first_cell(tet, 2) + row / ny;
    masks[item] = corner_mask_of(tet, x * cell_edge, y * cell_edge, z * cell_edge);
  }
};

/// Marks the half-spaces in which each corner of a cell certainly lies.
///
/// Conservative: rounding never sets a bit.
/// @param exec            where to run
/// @param setups          from tet_setup, shape [tet_count]
/// @param corner_offsets  first corner of each tetrahedron, shape [tet_count + 1]
/// @param masks           out, as many as there are corners
///
/// Determinism: bits may differ between back ends within the margin of a plane; the output cannot.
/// Cost: 4 plane values, 2 bytes written per corner.
/// Source: Gascon et al. 2013, section 4; the margin and the inside bits are ours.
template <class Exec, class Offsets>
void corner_mask(Exec& exec,
                 View<const TetSetup> setups,
                 const Offsets& corner_offsets,
                 View<std::uint16_t> masks) {
  exec.for_each_item("warp/mask", corner_offsets, masks.size, CornerMaskOp{setups, masks});
}

/// Rejects a cell if the masks of its eight corners share an outside bit, and accepts it if all
/// have all inside bits.
template <class Offsets>
struct MaskVerdict {
  Offsets corner_offsets;
  View<const std::uint16_t> masks;  ///< from corner_mask()

  /// @param cell  of the box of tetrahedron t [cell]
  /// @returns `partial` where masks are missing, as their memory was too small: the step is
  /// repeated
  TETWARP_HD CellVerdict operator()(const TetSetup& tet,
                                    std::int64_t t,
                                    const std::int64_t* cell) const {
    const std::int64_t line = corners_along(tet, 0), slice = line * corners_along(tet, 1);
    const std::int64_t first = corner_offsets[t] + (cell[0] - first_cell(tet, 0)) +
                               (cell[1] - first_cell(tet, 1)) * line +
                               (cell[2] - first_cell(tet, 2)) * slice;
    if (first + slice + line + 1 >= masks.size) return CellVerdict::partial;
    unsigned all = ~0u;
    for (int corner = 0; corner < 8; ++corner) {
      all &= masks[first + (corner & 1) + (corner >> 1 & 1) * line + (corner >> 2) * slice];
    }
    if ((all & outside_bits) != 0) return CellVerdict::rejected;
    return (all & inside_bits) == inside_bits ? CellVerdict::accepted : CellVerdict::partial;
  }
};

}  // namespace tetwarp

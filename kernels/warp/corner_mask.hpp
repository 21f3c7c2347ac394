/// @file corner_mask.hpp
/// Stage "mask" of the warp: half-spaces of a tetrahedron that certainly contain a corner of a
/// cell.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
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

/// One item = one coarse corner of one tetrahedron's box; any order.
struct CornerMaskBody {
  View<const TetSetup> setups;
  View<std::uint16_t> masks;

  TETWARP_HD void operator()(std::int64_t t, std::int64_t local, std::int64_t item) const {
    const TetSetup& tet = setups[t];
    const int nx = last_cell(tet, 0) - first_cell(tet, 0) + 2;
    const int ny = last_cell(tet, 1) - first_cell(tet, 1) + 2;
    const std::int64_t row = local / nx;
    const std::int64_t x = first_cell(tet, 0) + local % nx;
    const std::int64_t y = first_cell(tet, 1) + row % ny;
    const std::int64_t z = first_cell(tet, 2) + row / ny;
    masks[item] = corner_mask_of(tet, x * cell_edge, y * cell_edge, z * cell_edge);
  }
};

/// Marks the half-spaces in which each corner of a cell certainly lies. A cell is rejected if all
/// its eight masks share an outside bit, and accepted if all have all inside bits.
///
/// Conservative: rounding never sets a bit, so culling never changes the output.
/// @param exec            where to run
/// @param setups          from tet_setup, shape [tet_count]
/// @param corner_offsets  first corner of each tetrahedron, shape [tet_count + 1]
/// @param masks           out, as many as there are corners
///
/// Determinism: bits may differ between back ends within the margin of a plane; the output cannot.
/// Cost: 4 plane values, 2 bytes written per corner.
/// Source: Gascon et al. 2013, section 4; the margin and the inside bits are ours.
template <class Exec>
void corner_mask(Exec& exec,
                 View<const TetSetup> setups,
                 View<const std::int64_t> corner_offsets,
                 View<std::uint16_t> masks) {
  exec.for_each_item("warp/mask", corner_offsets, masks.size, CornerMaskBody{setups, masks});
}

}  // namespace tetwarp

/// @file voxel_cells.hpp
/// Stage "fields" of the warp, last part: converts owners from tetrahedra to elements of the mesh.
#pragma once
#include <cstdint>

#include "kernels/base/hex_view.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// One index = one voxel; any order.
struct VoxelCellOp {
  HexView hexes;
  OutputFrame frame;
  View<const std::uint8_t> touched;  ///< output cells that the raster wrote; size 0: all
  View<std::int32_t> owners;         ///< in: tetrahedra, out: mesh elements

  TETWARP_HD void operator()(std::int64_t voxel) const {
    int x[3];
    frame.set_voxel(voxel, x);
    const std::int64_t cell = frame.cell_of_voxel(x);
    if (touched.size > 0 && touched[cell] == 0) return;
    owners[voxel] = static_cast<std::int32_t>(hexes.cell_of(owners[voxel]));
  }
};

/// Replaces owners that are parts of hexahedra by the index of the mesh element, see
/// HexView::cell_of().
///
/// @param exec     where to run
/// @param hexes    of the mesh; without any the call does nothing
/// @param frame    the output
/// @param touched  output cells that this step wrote; empty: all
/// @param owners   in: tetrahedra, out: mesh elements, shape [voxel_count]; empty: none
///
/// Determinism: same bits on every back end. Cost: 8 bytes per voxel.
/// Source: ours.
template <class Exec>
void voxel_cells(Exec& exec,
                 const HexView& hexes,
                 const OutputFrame& frame,
                 View<const std::uint8_t> touched,
                 View<std::int32_t> owners) {
  if (hexes.nodes.size == 0) return;
  exec.for_each("warp/fields", owners.size, VoxelCellOp{hexes, frame, touched, owners});
}

}  // namespace tetwarp

/// @file voxel_count.hpp
/// Stage "raster" of the warp: counts folded voxels.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/base/view.hpp"
#include "kernels/warp/cell_pairs.hpp"
#include "kernels/warp/face_sign.hpp"

namespace tetwarp {

/// One index = one voxel of the output; any order. Counts voxels strictly inside two or more
/// tetrahedra.
struct VoxelFoldOp {
  View<const std::int32_t> tets;
  View<const Node> nodes;
  PairList list;
  View<const std::uint8_t> touched;  ///< cells to count in; size 0: all
  OutputFrame frame;
  View<std::int64_t> folded;
  std::int64_t weight;  ///< added per folded voxel: 1, or -1 to subtract an earlier count

  TETWARP_HD void operator()(std::int64_t voxel) const {
    int x[3];
    frame.set_voxel(voxel, x);
    const std::int64_t cell = frame.cell_of_voxel(x);
    if (touched.size > 0 && touched[cell] == 0) return;
    const std::int64_t end = end_of_cell(list, cell);
    int inside = 0;
    for (std::int64_t p = list.ranges[cell].begin; p < end && inside < 2; ++p) {
      const TetNodes tet = tet_nodes(nodes, tets.data + std::int64_t{4} * tet_of(list.pairs[p]));
      inside += is_inside_exact(tet, x[0], x[1], x[2], true);
    }
    if (inside == 2) atomic_add(&folded[0], weight);
  }
};

}  // namespace tetwarp

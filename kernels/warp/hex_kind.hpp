/// @file hex_kind.hpp
/// Tests whether the trilinear map of a hexahedron is a whole-voxel shift or affine.
#pragma once
#include <cstdint>

#include "kernels/base/hex_view.hpp"
#include "kernels/warp/face_sign.hpp"

namespace tetwarp {

/// Whether all nodes of a hexahedron move by the whole-voxel shift `shift`, to within a quantum.
TETWARP_HD bool has_whole_shift(const std::int32_t* hex,
                                View<const Node> output,
                                View<const Node> source,
                                const std::int64_t* shift) {
  bool whole = true;
  for (int a = 0; a < 8; ++a) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t rest =
          source[hex[a]].x[axis] - output[hex[a]].x[axis] - shift[axis] * quanta_per_voxel;
      whole = whole && rest >= -1 && rest <= 1;
    }
  }
  return whole;
}

/// Whether a tetrahedron's map takes all nodes of its hexahedron to their rest positions, to within
/// the rounding of nodes. Then the trilinear map is this affine map.
/// @param map, anchor  as in TetSetup
TETWARP_HD bool maps_all(const double (*map)[4],
                         const std::int64_t* anchor,
                         const std::int32_t* hex,
                         View<const Node> output,
                         View<const Node> source) {
  constexpr double slack = 4, voxel = 1.0 / quanta_per_voxel;
  bool all = true;
  for (int a = 0; a < 8; ++a) {
    double from[3];
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t quanta = output[hex[a]].x[axis] - anchor[axis] * quanta_per_voxel;
      from[axis] = static_cast<double>(quanta) * voxel;
    }
    for (int row = 0; row < 3; ++row) {
      const double at =
          map[0][row] * from[0] + map[1][row] * from[1] + map[2][row] * from[2] + map[3][row];
      const double to = static_cast<double>(source[hex[a]].x[row]) * voxel;
      all = all && fabs(at - to) <= slack * voxel;
    }
  }
  return all;
}

}  // namespace tetwarp

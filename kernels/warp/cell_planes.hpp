/// @file cell_planes.hpp
/// Inside test of voxels in float32, relative to a cell: decides all but those close to a face.
#pragma once
#include "kernels/base/hd.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// The four planes of a tetrahedron relative to one cell in float32. Scaled so that a value above 1
/// is certainly inside, and one below -1 certainly outside, despite rounding.
struct CellPlanes {
  float value[4];    ///< at the cell's corner voxel
  float step[3][4];  ///< per voxel along i, j, k
};

/// One of the planes.
struct CellPlane {
  float value;
  float step[3];
};

/// One float32 plane relative to a cell's first voxel `corner` [frame].
///
/// With u = 2^-24 and v a plane's distance from the corner in voxels, rounding the five inputs,
/// three products and three sums of a plane value costs at most u (5 |v| + 130), fused or not; the
/// unit of the scaled planes is u (8 |v| + 192).
TETWARP_HD CellPlane cell_plane(const TetSetup& tet, int face, const int* corner) {
  const double value = tet.plane[0][face] * static_cast<double>(corner[0] - tet.anchor[0]) +
                       tet.plane[1][face] * static_cast<double>(corner[1] - tet.anchor[1]) +
                       tet.plane[2][face] * static_cast<double>(corner[2] - tet.anchor[2]) +
                       tet.plane[3][face];
  const double scale = 1.0 / ((fabs(value) + 24.0) * 0x1p-21);
  return {static_cast<float>(value * scale),
          {static_cast<float>(tet.plane[0][face] * scale),
           static_cast<float>(tet.plane[1][face] * scale),
           static_cast<float>(tet.plane[2][face] * scale)}};
}

/// Stores the plane of a face.
TETWARP_HD void set_cell_plane(const CellPlane& plane, int face, CellPlanes& planes) {
  planes.value[face] = plane.value;
  for (int axis = 0; axis < 3; ++axis) planes.step[axis][face] = plane.step[axis];
}

/// The planes' values at voxel (i, j, 0) of the cell.
TETWARP_HD void set_column(const CellPlanes& planes, int i, int j, float* column) {
  for (int face = 0; face < 4; ++face) {
    const float row = planes.value[face] + planes.step[1][face] * static_cast<float>(j);
    column[face] = row + planes.step[0][face] * static_cast<float>(i);
  }
}

/// Least of the planes' values at voxel (i, j, k) of the cell.
/// @param column  from set_column() for i and j
TETWARP_HD float least_plane(const CellPlanes& planes, const float* column, int k) {
  float value[4];
  for (int face = 0; face < 4; ++face) {
    value[face] = column[face] + planes.step[2][face] * static_cast<float>(k);
  }
  return smaller_of(smaller_of(value[0], value[1]), smaller_of(value[2], value[3]));
}

/// +1: certainly inside; -1: certainly outside; 0: too close to a face for float32 to decide.
TETWARP_HD int certain_side(const CellPlanes& planes, int i, int j, int k) {
  float column[4];
  set_column(planes, i, j, column);
  const float least = least_plane(planes, column, k);
  return least > 1.0f ? 1 : least < -1.0f ? -1 : 0;
}

}  // namespace tetwarp

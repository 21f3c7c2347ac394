/// @file paper_tet.hpp
/// One tetrahedron in the method of Gascon et al. 2013, algorithm 1, in float32: barycentric
/// coordinates of a voxel, masks of grid points around cells of 8 x 8 x 8 voxels, the sample.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp::bench {

/// Rows of the barycentric map, rest positions as columns, and the voxels of the bounding box, both
/// ends included. Positions in voxels of the output and of the source.
struct PaperTet {
  float barycentric[4][4];
  float rest[3][4];
  int low[3], high[3];

  /// Cells along an axis; the first begins at `low`.
  TETWARP_HD int cells(int axis) const {
    return high[axis] < low[axis] ? 0 : (high[axis] - low[axis]) / cell_edge + 1;
  }
  TETWARP_HD std::int64_t cell_count() const {
    return std::int64_t{cells(0)} * cells(1) * cells(2);
  }
  /// Grid points: the corners of the cells.
  TETWARP_HD std::int64_t point_count() const {
    return cell_count() == 0 ? 0 : std::int64_t{cells(0) + 1} * (cells(1) + 1) * (cells(2) + 1);
  }
  TETWARP_HD float coordinate(int node, int x, int y, int z) const {
    const float* const row = barycentric[node];
    return row[0] * static_cast<float>(x) + row[1] * static_cast<float>(y) +
           row[2] * static_cast<float>(z) + row[3];
  }
};

/// Voxels of the source or of the output.
template <class T>
struct PaperVolume {
  T* samples;  ///< [k][j][i]
  int dims[3];
};

/// @param deformed, rest  positions of the nodes in voxels of the output and of the source
/// @param dims            of the output
TETWARP_HD PaperTet make_paper_tet(const double (*deformed)[3],
                                   const double (*rest)[3],
                                   const int* dims) {
  PaperTet tet;
  double edge[3][3];  // [axis][node - 1], from node 0
  for (int axis = 0; axis < 3; ++axis) {
    double low = deformed[0][axis], high = low;
    for (int n = 1; n < 4; ++n) {
      edge[axis][n - 1] = deformed[n][axis] - deformed[0][axis];
      low = min_of(low, deformed[n][axis]);
      high = max_of(high, deformed[n][axis]);
    }
    tet.low[axis] = max_of(0, static_cast<int>(ceil(low)));
    tet.high[axis] = min_of(dims[axis] - 1, static_cast<int>(floor(high)));
    for (int n = 0; n < 4; ++n) tet.rest[axis][n] = static_cast<float>(rest[n][axis]);
  }
  double minor[3][3];  // of the edges, with its sign
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int a = (row + 1) % 3, b = (row + 2) % 3, x = (column + 1) % 3, y = (column + 2) % 3;
      minor[row][column] = edge[a][x] * edge[b][y] - edge[a][y] * edge[b][x];
    }
  }
  const double determinant =
      edge[0][0] * minor[0][0] + edge[0][1] * minor[0][1] + edge[0][2] * minor[0][2];
  double first[4] = {0, 0, 0, 1};
  for (int n = 1; n < 4; ++n) {
    double offset = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double weight = minor[axis][n - 1] / determinant;
      tet.barycentric[n][axis] = static_cast<float>(weight);
      first[axis] -= weight;
      offset -= weight * deformed[0][axis];
    }
    tet.barycentric[n][3] = static_cast<float>(offset);
    first[3] -= offset;
  }
  for (int column = 0; column < 4; ++column) {
    tet.barycentric[0][column] = static_cast<float>(first[column]);
  }
  return tet;
}

/// Bit 2n: below 0, bit 2n + 1: above 1, of barycentric coordinate n at a grid point.
/// @param point  number of the grid point, along x fastest
TETWARP_HD std::uint8_t paper_mask(const PaperTet& tet, std::int64_t point) {
  const int nx = tet.cells(0) + 1, ny = tet.cells(1) + 1;
  const int x = tet.low[0] + cell_edge * static_cast<int>(point % nx);
  const int y = tet.low[1] + cell_edge * static_cast<int>(point / nx % ny);
  const int z = tet.low[2] + cell_edge * static_cast<int>(point / nx / ny);
  unsigned mask = 0;
  for (int n = 0; n < 4; ++n) {
    const float b = tet.coordinate(n, x, y, z);
    mask |= unsigned(b < 0) << (2 * n) | unsigned(b > 1) << (2 * n + 1);
  }
  return static_cast<std::uint8_t>(mask);
}

/// Whether the eight corners of a cell share no bit of their masks.
/// @param masks  of all grid points of the tetrahedron
/// @param cell   number of the cell, along x fastest
TETWARP_HD bool paper_keeps(const PaperTet& tet, const std::uint8_t* masks, std::int64_t cell) {
  const std::int64_t nx = tet.cells(0), ny = tet.cells(1), line = nx + 1, slice = line * (ny + 1);
  const std::int64_t first = cell % nx + cell / nx % ny * line + cell / nx / ny * slice;
  unsigned shared = 255;
  for (int corner = 0; corner < 8; ++corner) {
    shared &= masks[first + (corner & 1) + (corner >> 1 & 1) * line + (corner >> 2) * slice];
  }
  return shared == 0;
}

TETWARP_HD float paper_trilinear(const PaperVolume<const float>& source, const float* x) {
  float fraction[3];
  int low[3];
  for (int axis = 0; axis < 3; ++axis) {
    const int last = source.dims[axis] - 1;
    const float inside = min_of(max_of(x[axis], 0.0f), static_cast<float>(last));
    low[axis] = min_of(static_cast<int>(inside), last - 1);
    fraction[axis] = inside - static_cast<float>(low[axis]);
  }
  const std::int64_t row = source.dims[0], slice = row * source.dims[1];
  const float* const p = source.samples + low[2] * slice + low[1] * row + low[0];
  float along_y[2];
  for (int z = 0; z < 2; ++z) {
    const float* const q = p + z * slice;
    const float a = q[0] + fraction[0] * (q[1] - q[0]);
    const float b = q[row] + fraction[0] * (q[row + 1] - q[row]);
    along_y[z] = a + fraction[1] * (b - a);
  }
  return along_y[0] + fraction[2] * (along_y[1] - along_y[0]);
}

/// Tests one voxel; where it passes, writes its sample.
/// @param at  where the voxel lies in the output
/// @returns whether the tetrahedron contains the voxel's center
TETWARP_HD bool paper_draw(
    const PaperTet& tet, const PaperVolume<const float>& source, int x, int y, int z, float* at) {
  float b[4];
  for (int n = 0; n < 4; ++n) b[n] = tet.coordinate(n, x, y, z);
  if (b[0] < 0 || b[1] < 0 || b[2] < 0 || b[3] < 0) return false;
  float position[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float* const rest = tet.rest[axis];
    position[axis] = rest[0] * b[0] + rest[1] * b[1] + rest[2] * b[2] + rest[3] * b[3];
  }
  *at = paper_trilinear(source, position);
  return true;
}

}  // namespace tetwarp::bench

/// @file row_scalar.hpp
/// Rows whose voxels are written one by one on the CPU: hexahedra, filters wider than linear,
/// labels under steep maps, positions at the end of the source, voxels without an owner.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// A tetrahedron and its map over one cell. The map is that of SourceMap<float>: numbers per axis
/// of the source, the fourth unused.
struct RowMap {
  std::int64_t tet;
  const TetSetup& setup;
  const int* corner;  ///< of the cell [frame voxel]
  const float* base;
  const float (*axis)[4];
  const std::int32_t* whole;
};

/// Defined for every pixel type.
template <class T>
struct ScalarRows {
  /// Writes the voxels `bits` of row (j, k) of a cell, which the map's tetrahedron owns: by its
  /// rule, else by the map of its hexahedron, else by the job's filter. With nearest and linear the
  /// map must then be affine and the pixel type one with float32 arithmetic.
  /// @param row  of voxel (0, j, k) of the cell in the output
  static void write(
      const RasterJob<T>& job, const RowMap& map, unsigned bits, int j, int k, std::int64_t row);

  /// Writes voxels [begin, end) of row (j, k) of a line of cells, which no tetrahedron covers.
  /// @param job    its volume is the row, from voxel 0 on
  /// @param first  first voxel of the line's first cell
  static void write_outside(
      const RasterJob<T>& job, const int* first, int begin, int end, int j, int k);
};

}  // namespace tetwarp

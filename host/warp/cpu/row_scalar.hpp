/// @file row_scalar.hpp
/// Rows whose voxels are written one by one on the CPU: transformed voxels, hexahedra, filters
/// wider than linear, labels.
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
  /// rule, else by the map of its hexahedron, else by the job's filter, which is then wider than
  /// linear or labels.
  /// @param row  of voxel (0, j, k) of the cell in the output
  static void write(
      const RasterJob<T>& job, const RowMap& map, unsigned bits, int j, int k, std::int64_t row);

  /// Writes voxel (i, j, k) of the cell at `corner`, which no tetrahedron covers.
  static void write_outside(
      const RasterJob<T>& job, const int* corner, int i, int j, int k, std::int64_t voxel);
};

}  // namespace tetwarp

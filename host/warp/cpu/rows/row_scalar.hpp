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

/// Writes the voxels `bits` of row (j, k) of a cell, which the map's tetrahedron owns: by its
/// rule, else by the map of its hexahedron, else by the job's filter. With nearest and linear the
/// map must then be affine and the pixel type one with float32 arithmetic.
/// @param job  a RasterJob of pixel type `type`
/// @param row  of voxel (0, j, k) of the cell in the output
void write_scalar_run(PixelType type,
                      const RasterGeometry& job,
                      const RowMap& map,
                      unsigned bits,
                      int j,
                      int k,
                      std::int64_t row);

/// Writes voxels [begin, end) of row (j, k) of a line of cells, which no tetrahedron covers.
/// @param job    a RasterJob of pixel type `type`; its volume is the row, from voxel 0 on
/// @param first  first voxel of the line's first cell
void write_scalar_outside(
    PixelType type, const RasterGeometry& job, const int* first, int begin, int end, int j, int k);

}  // namespace tetwarp

/// @file row_filtered.hpp
/// Samples of a row by the filters wider than linear and by labels, on the CPU.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// The map of a tetrahedron over a cell, as SourceMap<float> has it: four numbers per axis of the
/// output, of which one is not used.
struct RowMap {
  const TetSetup& tet;
  const int* corner;  ///< of the cell
  const float* base;
  const float (*axis)[4];
  const std::int32_t* whole;
};

/// The voxels `bits` of row (j, k) of a cell, with the bits of store_wide_sample().
/// @param row  of voxel (0, j, k) of the cell in the output
template <class T>
void sample_row_filtered(
    const RasterJob<T>& job, const RowMap& map, unsigned bits, int j, int k, std::int64_t row);

}  // namespace tetwarp

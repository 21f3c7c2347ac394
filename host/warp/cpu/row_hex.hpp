/// @file row_hex.hpp
/// Samples of a row within a hexahedron, on the CPU, voxel by voxel.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// The voxels `bits` of row (j, k) of the cell at `corner`, which tetrahedron t owns, a part of a
/// hexahedron whose map is trilinear.
/// @param row  of voxel (0, j, k) of the cell in the output
template <class T>
void sample_row_hex(const RasterJob<T>& job,
                    std::int64_t t,
                    const int* corner,
                    unsigned bits,
                    int j,
                    int k,
                    std::int64_t row);

}  // namespace tetwarp

/// @file row_transformed.hpp
/// Voxels that get more than a plain sample, on the CPU, one by one.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// The voxels `bits` of row (j, k) of the cell at `corner`, which tetrahedron t owns, by its
/// transform.
/// @param row  of voxel (0, j, k) of the cell in the output
template <class T>
void write_row_transformed(const RasterJob<T>& job,
                           std::int64_t t,
                           const int* corner,
                           unsigned bits,
                           int j,
                           int k,
                           std::int64_t row);

/// Voxel (i, j, k) of the cell at `corner`, which no tetrahedron covers.
template <class T>
void write_outside_transformed(
    const RasterJob<T>& job, const int* corner, int i, int j, int k, std::int64_t voxel);

}  // namespace tetwarp

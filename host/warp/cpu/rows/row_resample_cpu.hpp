/// @file row_resample_cpu.hpp
/// Stage "resample" on host threads: eight voxels of a row in vectors.
#pragma once
#include <cstdint>

#include <tetwarp/volume.hpp>

#include "kernels/warp/row_resample.hpp"

namespace tetwarp {

/// Lines of 8 x 8 rows of an output.
std::int64_t resample_lines(const std::int64_t* dims);

/// Resamples lines [begin, end) of the output: one component of float32 arithmetic by nearest or
/// linear in vectors, all others row by row. By an affine map and a field whose grid is the
/// output's or parallel to it, positions are relative to those of the first of eight voxels in
/// float32. By other links they are those
/// of TransformLink in float64, but vectors of fields are interpolated in float32: within 2^-21 of
/// the largest one around.
/// @param type  T of the job
/// @param body  a RowResampleOp<T>
void resample_lines(PixelType type, const void* body, std::int64_t begin, std::int64_t end);

}  // namespace tetwarp

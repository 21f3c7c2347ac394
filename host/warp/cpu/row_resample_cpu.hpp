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
/// linear in vectors, from positions relative to those of the first of eight voxels in float32, all
/// others row by row.
/// @param type  T of the job
/// @param body  a RowResampleOp<T>
void resample_lines(PixelType type, const void* body, std::int64_t begin, std::int64_t end);

}  // namespace tetwarp

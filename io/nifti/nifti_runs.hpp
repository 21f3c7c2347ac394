/// @file nifti_runs.hpp
/// Regions of a grid as runs of voxels that follow each other in a file and in the region.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// Bytes that are read, written or converted at a time.
constexpr std::size_t nifti_part_bytes = std::size_t{1} << 20;

/// Calls `op(voxel_in_grid, voxel_in_region, count)` for runs of at most `most` voxels, in the
/// order of the file, until it returns false. @returns false when it did
template <class Op>
bool for_each_run(const std::array<std::int64_t, 3>& dims,
                  const Region& region,
                  std::int64_t most,
                  const Op& op) {
  std::array<std::int64_t, 3> extent{};
  for (std::size_t axis = 0; axis < 3; ++axis) extent[axis] = region.end[axis] - region.begin[axis];
  // Whole rows follow each other in the file, and so do whole slices.
  const bool has_rows = extent[0] == dims[0];
  const bool has_slices = has_rows && extent[1] == dims[1];
  const std::int64_t rows = has_rows ? extent[1] : 1;
  const std::int64_t run = extent[0] * rows * (has_slices ? extent[2] : 1);
  for (std::int64_t k = 0; k < (has_slices ? 1 : extent[2]); ++k) {
    for (std::int64_t j = 0; j < extent[1]; j += rows) {
      const std::int64_t in_grid =
          ((region.begin[2] + k) * dims[1] + region.begin[1] + j) * dims[0] + region.begin[0];
      const std::int64_t in_region = (k * extent[1] + j) * extent[0];
      for (std::int64_t done = 0; done < run; done += most) {
        if (!op(in_grid + done, in_region + done, std::min(most, run - done))) return false;
      }
    }
  }
  return true;
}

/// Copies `count` elements of `size` bytes from every `in_stride`-th to every `out_stride`-th one.
inline void copy_strided(const std::byte* in,
                         std::size_t in_stride,
                         std::byte* out,
                         std::size_t out_stride,
                         std::size_t size,
                         std::size_t count) {
  if (in_stride == 1 && out_stride == 1) {
    std::memcpy(out, in, size * count);
    return;
  }
  for (std::size_t v = 0; v < count; ++v) {
    std::memcpy(out + v * out_stride * size, in + v * in_stride * size, size);
  }
}

}  // namespace tetwarp

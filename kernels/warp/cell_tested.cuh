/// @file cell_tested.cuh
/// Stage "raster" of the warp as a CUDA kernel, for cells that are not interior. Cells of several
/// tetrahedra whose samples all lie in the source have tests as in cell_raster.cuh and samples
/// without clamps and switches; the others are computed as there.
#pragma once
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cell_raster.cuh"
#include "kernels/warp/interior_sample.hpp"

namespace tetwarp {

static_assert(most_tested_pairs == raster_chunk);

/// A cell of class `tested`. Voxels that no tetrahedron covers are sampled by the map of the first
/// one, which stays in the source too, and stored as background. Called by all threads of a block.
/// @param starts        shared, raster_chunk entries
/// @param block_counts  shared, 4 entries
template <class T>
__device__ __forceinline__ void tested_cell(const RasterJob<T>& job,
                                            std::uint32_t cell,
                                            RasterChunk<float>& chunk,
                                            const T** starts,
                                            int* block_counts) {
  int corner[3];
  job.frame.set_corner(cell, corner);
  const int thread = static_cast<int>(threadIdx.x);
  const int i = thread & 7, j = thread >> cell_shift & 7, k_first = thread >> 2 * cell_shift;
  const CellRange range = job.ranges[cell];
  const auto count = static_cast<int>(range.end - range.begin);
  if (thread < 4) block_counts[thread] = 0;
  load_chunk(job, range.begin, count, corner, chunk);
  __syncthreads();
  if (thread < count) {
    const int* const whole = chunk.maps[thread].whole;
    starts[thread] = job.source.data + voxel_of(job.source, whole[0], whole[1], whole[2]);
  }
  __syncthreads();

  RasterCounts mine = {0, 0, 0, 0};
  VoxelBits open = all_voxels;
  const auto slots = find_owners(job, chunk, count, corner, i, j, k_first, open, mine);
  mine.covered = raster_depth - __popc(open);
  const SourceSteps steps(job.source.dims);
  InteriorTap taps[raster_depth];
  SampleCube<T> cubes[raster_depth];
  for (int d = 0; d < raster_depth; ++d) {
    const int slot = slot_of(slots, d);
    float x[3];
    local_position(chunk.maps[slot], i, j, k_first + 2 * d, x);
    taps[d] = interior_tap(x);
    cubes[d] = steps.cube(kept(starts[slot] + steps.offset_of(taps[d])));
  }
  const int slice =
      (job.frame.end[0] - job.frame.begin[0]) * (job.frame.end[1] - job.frame.begin[1]);
  const std::int64_t first = job.frame.offset_of(corner[0] + i, corner[1] + j, corner[2]);
  T* const out = job.volume + first;
  for (int d = 0; d < raster_depth; ++d) {
    const int at = (k_first + 2 * d) * slice;
    const bool covered = !has_voxel(open, d);
    out[at] = covered ? interior_value(cubes[d], taps[d]) : job.background;
    if (job.mask != nullptr) job.mask[first + at] = covered;
    if (job.tet != nullptr) job.tet[first + at] = covered ? chunk.tet[slot_of(slots, d)] : -1;
  }
  __syncthreads();
  add_counts(job, cell, mine, block_counts);
}

/// Computes the listed cells of class `tested`, then those of class `general`.
///
/// Blocks: at least one per listed cell; those after both lists end at once. Threads:
/// raster_threads.
/// @param general  null: these cells are left out, as those of hexahedra must be
template <class T>
__global__ void __launch_bounds__(raster_threads, raster_blocks<T, false>())
    cell_tested_kernel(RasterJob<T> job,
                       const std::uint32_t* tested,
                       const std::uint32_t* general,
                       const CellListCounts* counts) {
  __shared__ RasterChunk<float> chunk;
  __shared__ const T* starts[raster_chunk];
  __shared__ int block_counts[4];

  const int block = static_cast<int>(blockIdx.x), tested_count = counts->tested;
  if (block < tested_count) {
    tested_cell(job, tested[block], chunk, starts, block_counts);
  } else if (general != nullptr && block - tested_count < counts->general) {
    raster_cell<false>(job, general[block - tested_count], chunk, block_counts);
  }
}

}  // namespace tetwarp

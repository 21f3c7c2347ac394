/// @file cell_raster.cuh
/// Stage "raster" of the warp as a CUDA kernel: one block writes each voxel of one output cell
/// once, background included: no races on shared faces, no separate clearing.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cuda/cell_owners.cuh"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

/// Minimum blocks per multiprocessor: five leave 96 registers to a thread. The general kernel needs
/// more on every architecture, the plain one on sm_120: with fewer blocks none spills.
template <class T, bool is_general>
constexpr int raster_blocks() {
  if (is_general) return 2;
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 1200
  return 4;
#else
  return 5;
#endif
}

/// Voxels of the output among those of this thread.
__device__ __forceinline__ VoxelBits
voxels_in_output(const OutputFrame& frame, const int* corner, int i, int j, int k) {
  VoxelBits voxels = 0;
  for (int d = 0; d < raster_depth; ++d) {
    const int x[3] = {corner[0] + i, corner[1] + j, corner[2] + k + 2 * d};
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
      within = within && x[axis] >= frame.begin[axis] && x[axis] < frame.end[axis];
    }
    voxels |= static_cast<VoxelBits>(within) << 8 * d;
  }
  return voxels;
}

/// Stores a voxel whose owner is tetrahedron `slot` of the chunk.
/// @param work  of the cell, see RasterGeometry::cell_work
template <bool is_general, class T>
__device__ __forceinline__ void store_covered(const RasterJob<T>& job,
                                              const RasterChunk<ArithmeticOf<T>>& chunk,
                                              int slot,
                                              std::int64_t work,
                                              const CellVoxel& voxel,
                                              ThreadCounts& mine) {
  const int t = chunk.tet[slot];
  const bool transformed = is_general && has_transform(job, t);
  ++mine.covered;
  mine.copied += chunk.copied[slot] && !transformed;
  if (work >= 0) {
    store_filled(job, work, voxel.offset);
  } else if (transformed) {
    store_transformed_voxel(job, t, voxel);
  } else if ((is_general || sizeof(ArithmeticOf<T>) == 4) && chunk.own_map[slot]) {
    store_owned<is_general, T, double>(job, t, voxel);
  } else {
    store_sample<is_general>(job, chunk.copied[slot] ? Filter::nearest : job.filter,
                             chunk.maps[slot], voxel);
  }
  if (job.mask != nullptr) job.mask[voxel.offset] = 1;
  if (job.tet != nullptr) job.tet[voxel.offset] = t;
}

/// Stores a voxel of the output that no tetrahedron covers.
template <bool is_general, class T>
__device__ __forceinline__ void store_uncovered(const RasterJob<T>& job, const CellVoxel& voxel) {
  if (is_general && has_outside_transform(job)) {
    store_transformed_outside(job, voxel);
  } else {
    store_outside<is_general>(job, voxel);
  }
  if (job.mask != nullptr) job.mask[voxel.offset] = 0;
  if (job.tet != nullptr) job.tet[voxel.offset] = -1;
}

/// Adds the counts of all threads of the block to those of the job.
/// @param number        selects the place of the job's counts, of a cell or block
/// @param block_counts  shared, four zeros that all threads see; out, the sums
__device__ __forceinline__ void add_counts(const RasterGeometry& job,
                                           std::int64_t number,
                                           const ThreadCounts& mine,
                                           int* block_counts) {
  const int thread = static_cast<int>(threadIdx.x);
  atomicAdd(&block_counts[0], mine.covered);
  atomicAdd(&block_counts[1], mine.inside_tests);
  atomicAdd(&block_counts[2], mine.exact_tests);
  atomicAdd(&block_counts[3], mine.copied);
  __syncthreads();
  if (job.counts != nullptr && thread < 4 && block_counts[thread] != 0) {
    RasterCounts* const counts = job.counts + (number & (job.count_places - 1));
    atomic_add(reinterpret_cast<std::int64_t*>(counts) + thread, block_counts[thread]);
  }
}

/// Finds the owner of every voxel of a cell and stores its samples. Called by all threads of a
/// block.
/// @tparam is_general   whether the job may have wide filters, transforms or hexahedra
/// @param block_counts  shared, 4 entries
template <bool is_general, class T>
__device__ __forceinline__ void raster_cell(const RasterJob<T>& job,
                                            std::int64_t cell,
                                            RasterChunk<ArithmeticOf<T>>& chunk,
                                            int* block_counts) {
  const int thread = static_cast<int>(threadIdx.x);
  int corner[3];
  job.frame.set_corner(cell, corner);
  const int i = thread & 7, j = thread >> cell_shift & 7, k_first = thread >> 2 * cell_shift;
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return;
  const CellRange range = job.ranges[cell];
  ThreadCounts mine = {0, 0, 0, 0};
  VoxelBits open = voxels_in_output(job.frame, corner, i, j, k_first);  // without an owner yet
  if (thread < 4) block_counts[thread] = 0;
  const auto voxel_at = [&](int k) {
    return CellVoxel{corner, i, j, k,
                     job.frame.offset_of(corner[0] + i, corner[1] + j, corner[2] + k)};
  };

  for (std::uint32_t first = range.begin; first < range.end; first += raster_chunk) {
    const int count = static_cast<int>(min_of(range.end - first, std::uint32_t{raster_chunk}));
    __syncthreads();  // all threads have finished with the chunk before
    load_chunk(job, first, count, corner, chunk);
    __syncthreads();
    const VoxelBits before = open;
    const auto slots = find_owners(job, chunk, count, corner, i, j, k_first, open, mine);
    for (int d = 0; d < raster_depth; ++d) {
      if (!has_voxel(before & ~open, d)) continue;
      store_covered<is_general>(job, chunk, slot_of(slots, d), work, voxel_at(k_first + 2 * d),
                                mine);
    }
  }
  for (int d = 0; d < raster_depth; ++d) {
    if (has_voxel(open, d)) store_uncovered<is_general>(job, voxel_at(k_first + 2 * d));
  }

  __syncthreads();
  add_counts(job, cell, mine, block_counts);
  if (job.cell_covered.size > 0 && thread == 0) {
    job.cell_covered[cell] = static_cast<std::uint16_t>(block_counts[0]);
  }
}

/// All cells of a job, or those that it lists.
///
/// Blocks: one per cell of the job; any number where it lists cells. Threads: raster_threads.
/// Shared: one RasterChunk and four counters, about 2.2 KiB with float32, 3.0 KiB with float64
/// arithmetic.
template <class T, bool is_general>
__global__ void __launch_bounds__(raster_threads, raster_blocks<T, is_general>())
    cell_raster_kernel(RasterJob<T> job) {
  __shared__ RasterChunk<ArithmeticOf<T>> chunk;
  __shared__ int block_counts[4];

  if (job.listed == nullptr) {
    raster_cell<is_general>(job, static_cast<std::int64_t>(blockIdx.x), chunk, block_counts);
    return;
  }
  const int count = *job.listed_count;
  for (int at = static_cast<int>(blockIdx.x); at < count; at += static_cast<int>(gridDim.x)) {
    raster_cell<is_general>(job, job.listed[at], chunk, block_counts);
  }
}

/// The kernel for a job. Jobs with wide filters, transforms or hexahedra use the general kernel,
/// which needs more than twice the registers.
template <class T>
auto raster_kernel(const RasterJob<T>& job) {
  const bool is_plain =
      !is_wide(job.filter) && job.transforms.size == 0 && job.hexes.nodes.size == 0;
  return is_plain ? cell_raster_kernel<T, false> : cell_raster_kernel<T, true>;
}

}  // namespace tetwarp

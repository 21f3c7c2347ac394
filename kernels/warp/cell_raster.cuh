/// @file cell_raster.cuh
/// Stage "raster" of the warp as a CUDA kernel: one block writes each voxel of one output cell
/// once, background included: no races on shared faces, no separate clearing.
///
/// 128 threads in two layers of 64 (i fastest, so that a row of 8 voxels is one 32-byte sector of
/// float32), four voxels along k per thread. Planes, rows and maps of `raster_chunk` tetrahedra at
/// a time are computed by the first threads into shared memory, from which all threads read them.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

constexpr int raster_threads = 128;

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

constexpr int raster_chunk = 16;
constexpr int raster_depth = 4;  ///< voxels per thread, two apart along k

/// Data of up to `raster_chunk` tetrahedra in shared memory, one slot each.
template <class Real>
struct RasterChunk {
  CellPlanes planes[raster_chunk];
  SourceMap<Real> maps[raster_chunk];
  int tet[raster_chunk];
  std::uint16_t rows[raster_chunk];  ///< extent of the box in the cell: bits j, and bits 8 + k
  bool accepted[raster_chunk];
  bool copied[raster_chunk];
  bool own_map[raster_chunk];  ///< steep or trilinear: sampled by store_owned() instead of `maps`
};

/// Bit b for each voxel corner + b, b in 0..7, that lies in [begin, end).
__device__ __forceinline__ unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

/// Fills the chunk with the tetrahedra of pairs [first, first + count).
template <class T>
__device__ __forceinline__ void load_chunk(const RasterJob<T>& job,
                                           std::uint32_t first,
                                           int count,
                                           const int* corner,
                                           RasterChunk<ArithmeticOf<T>>& chunk) {
  const int thread = static_cast<int>(threadIdx.x);
  if (thread < 4 * count) {
    const CellPair pair = job.pairs[first + static_cast<unsigned>(thread / 4)];
    set_cell_plane(job.setups[tet_of(pair)], thread % 4, corner, chunk.planes[thread / 4]);
  } else if (thread >= 4 * raster_chunk && thread - 4 * raster_chunk < count) {
    const int slot = thread - 4 * raster_chunk;
    const CellPair pair = job.pairs[first + static_cast<unsigned>(slot)];
    const TetSetup& tet = job.setups[tet_of(pair)];
    double start[3], linear[3][3];
    map_start(tet, corner, start, linear);
    chunk.maps[slot] = make_source_map<ArithmeticOf<T>>(job.source, start, linear);
    chunk.tet[slot] = tet_of(pair);
    chunk.rows[slot] =
        static_cast<std::uint16_t>(bits_within(tet.begin[1], tet.end[1], corner[1]) |
                                   bits_within(tet.begin[2], tet.end[2], corner[2]) << cell_edge);
    chunk.accepted[slot] = is_accepted(pair);
    chunk.copied[slot] = is_copied(job, tet);
    chunk.own_map[slot] = tet.kind == MapKind::trilinear ||
                          (sizeof(ArithmeticOf<T>) == 4 && tet.kind == MapKind::steep);
  }
}

/// Slot of the tetrahedron in the chunk that owns voxel (i, j, k) of the cell; -1 if none does.
template <class T>
__device__ __forceinline__ int find_owner(const RasterJob<T>& job,
                                          const RasterChunk<ArithmeticOf<T>>& chunk,
                                          int count,
                                          const int* corner,
                                          int i,
                                          int j,
                                          int k,
                                          RasterCounts& mine) {
  for (int slot = 0; slot < count; ++slot) {
    if (chunk.accepted[slot]) return slot;
    if ((chunk.rows[slot] >> j & chunk.rows[slot] >> (cell_edge + k) & 1) == 0) continue;
    ++mine.inside_tests;
    const int side = certain_side(chunk.planes[slot], i, j, k);
    if (side > 0) return slot;
    if (side < 0) continue;
    ++mine.exact_tests;
    const TetNodes tet = tet_nodes(job.nodes, job.tets.data + std::int64_t{4} * chunk.tet[slot]);
    if (is_inside_exact(tet, corner[0] + i, corner[1] + j, corner[2] + k)) return slot;
  }
  return -1;
}

/// Voxels of the output among the `raster_depth` of this thread: bit d for (i, j, k + 2 d).
__device__ __forceinline__ unsigned voxels_in_output(
    const OutputFrame& frame, const int* corner, int i, int j, int k) {
  unsigned voxels = 0;
  for (int d = 0; d < raster_depth; ++d) {
    const int x[3] = {corner[0] + i, corner[1] + j, corner[2] + k + 2 * d};
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
      within = within && x[axis] >= frame.begin[axis] && x[axis] < frame.end[axis];
    }
    voxels |= static_cast<unsigned>(within) << d;
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
                                              RasterCounts& mine) {
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
/// @param block_counts  shared, four zeros that all threads see
template <class T>
__device__ __forceinline__ void add_counts(const RasterJob<T>& job,
                                           std::int64_t cell,
                                           const RasterCounts& mine,
                                           int* block_counts) {
  const int thread = static_cast<int>(threadIdx.x);
  atomicAdd(&block_counts[0], static_cast<int>(mine.covered));
  atomicAdd(&block_counts[1], static_cast<int>(mine.inside_tests));
  atomicAdd(&block_counts[2], static_cast<int>(mine.exact_tests));
  atomicAdd(&block_counts[3], static_cast<int>(mine.copied));
  __syncthreads();
  if (job.cell_covered.size > 0 && thread == 0) {
    job.cell_covered[cell] = static_cast<std::uint16_t>(block_counts[0]);
  }
  if (job.counts != nullptr && thread < 4 && block_counts[thread] != 0) {
    RasterCounts* const counts = job.counts + cell % job.count_places;
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
  const int i = thread % cell_edge;
  const int j = thread / cell_edge % cell_edge;
  const int k_first = thread / (cell_edge * cell_edge);
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return;
  const CellRange range = job.ranges[cell];
  RasterCounts mine = {0, 0, 0, 0};
  unsigned open = voxels_in_output(job.frame, corner, i, j, k_first);  // those without an owner yet
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
    for (int d = 0; d < raster_depth; ++d) {
      const int k = k_first + 2 * d;
      if ((open >> d & 1) == 0) continue;
      const int slot = find_owner(job, chunk, count, corner, i, j, k, mine);
      if (slot < 0) continue;
      open &= ~(1u << d);
      store_covered<is_general>(job, chunk, slot, work, voxel_at(k), mine);
    }
  }
  for (int d = 0; d < raster_depth; ++d) {
    if ((open >> d & 1) != 0) store_uncovered<is_general>(job, voxel_at(k_first + 2 * d));
  }

  __syncthreads();
  add_counts(job, cell, mine, block_counts);
}

/// All cells of a job, or those that it lists.
///
/// Blocks: one per cell of the job; where the job lists cells, those after the list end at once.
/// Threads: raster_threads. Shared: one RasterChunk and four counters, about
/// 2.1 KiB with float32, 2.9 KiB with float64 arithmetic.
template <class T, bool is_general>
__global__ void __launch_bounds__(raster_threads, raster_blocks<T, is_general>())
    cell_raster_kernel(RasterJob<T> job) {
  __shared__ RasterChunk<ArithmeticOf<T>> chunk;
  __shared__ int block_counts[4];

  std::int64_t cell = static_cast<std::int64_t>(blockIdx.x);
  if (job.listed != nullptr) {
    if (cell >= *job.listed_count) return;
    cell = job.listed[cell];
  }
  raster_cell<is_general>(job, cell, chunk, block_counts);
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

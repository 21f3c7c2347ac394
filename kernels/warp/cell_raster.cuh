/// @file cell_raster.cuh
/// Stage "raster" of the warp, mapped by hand: one block owns one output cell and writes each of
/// its voxels once, background included. No race on shared faces, no separate clear.
///
/// 128 threads, two layers of 64 (i fastest, so that a row of 8 voxels is one 32-byte sector of
/// float32), four voxels along k per thread. The planes, rows and maps of `raster_chunk` tetrahedra
/// at a time are made once per cell by the first threads and read by all from shared memory.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

constexpr int raster_threads = 128;
constexpr int raster_blocks = 5;  ///< resident per multiprocessor: leaves 96 registers, no spills
constexpr int raster_general_blocks = 2;  ///< the same of the kernel that knows the wide filters
constexpr int raster_chunk = 16;
constexpr int raster_depth = 4;  ///< voxels per thread, two apart along k

/// What a block knows of `raster_chunk` tetrahedra.
template <class Real>
struct RasterChunk {
  CellPlanes planes[raster_chunk];
  SourceMap<Real> maps[raster_chunk];
  int tet[raster_chunk];
  std::uint16_t rows[raster_chunk];  ///< of the box in the cell: bit j, and bit 8 + k
  bool accepted[raster_chunk];
  bool copied[raster_chunk];
  bool alone[raster_chunk];  ///< not by `maps`: steep or trilinear
};

/// Voxels [begin, end) that lie within the eight from `corner` on, one bit each.
__device__ __forceinline__ unsigned bits_within(int begin, int end, int corner) {
  const int first = min_of(max_of(begin - corner, 0), cell_edge);
  const int past = min_of(max_of(end - corner, 0), cell_edge);
  return ((1u << past) - 1) & ~((1u << first) - 1);
}

template <class T>
__device__ __forceinline__ void load_chunk(const RasterJob<T>& job,
                                           std::uint32_t first,
                                           int count,
                                           const int* corner,
                                           RasterChunk<ArithmeticOf<T>>& chunk) {
  const int thread = static_cast<int>(threadIdx.x);
  if (thread < 4 * count) {
    const CellPair pair = job.pairs[first + static_cast<unsigned>(thread / 4)];
    set_cell_plane(job.setups[tet_of(pair)], thread % 4, corner[0], corner[1], corner[2],
                   chunk.planes[thread / 4]);
  } else if (thread >= 4 * raster_chunk && thread - 4 * raster_chunk < count) {
    const int slot = thread - 4 * raster_chunk;
    const CellPair pair = job.pairs[first + static_cast<unsigned>(slot)];
    const TetSetup& tet = job.setups[tet_of(pair)];
    double start[3], linear[3][3];
    map_start(tet, corner[0], corner[1], corner[2], start, linear);
    chunk.maps[slot] = make_source_map<ArithmeticOf<T>>(job.source, start, linear);
    chunk.tet[slot] = tet_of(pair);
    chunk.rows[slot] =
        static_cast<std::uint16_t>(bits_within(tet.begin[1], tet.end[1], corner[1]) |
                                   bits_within(tet.begin[2], tet.end[2], corner[2]) << cell_edge);
    chunk.accepted[slot] = is_accepted(pair);
    chunk.copied[slot] = is_copied(job, tet);
    chunk.alone[slot] = tet.kind == MapKind::trilinear ||
                        (sizeof(ArithmeticOf<T>) == 4 && tet.kind == MapKind::steep);
  }
}

/// Slot of the voxel's owner in the chunk, or -1.
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

/// Blocks: one per cell. Threads: raster_threads. Shared: one RasterChunk and four counters, about
/// 2.5 KiB with float32, 4 KiB with float64 arithmetic.
template <class T, bool General>
__global__ void __launch_bounds__(raster_threads, General ? raster_general_blocks : raster_blocks)
    cell_raster_kernel(RasterJob<T> job) {
  using Real = ArithmeticOf<T>;
  __shared__ RasterChunk<Real> chunk;
  __shared__ int block_counts[4];

  const int thread = static_cast<int>(threadIdx.x);
  const std::int64_t cell = static_cast<std::int64_t>(blockIdx.x);
  const std::int64_t line = cell / job.frame.cells[0];
  const int corner[3] = {static_cast<int>(cell % job.frame.cells[0]) * cell_edge,
                         static_cast<int>(line % job.frame.cells[1]) * cell_edge,
                         static_cast<int>(line / job.frame.cells[1]) * cell_edge};
  const int i = thread % cell_edge;
  const int j = thread / cell_edge % cell_edge;
  const int k_first = thread / (cell_edge * cell_edge);
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return;
  const CellRange range = job.ranges[cell];
  RasterCounts mine = {0, 0, 0, 0};
  unsigned open = 0;  // bit d: voxel d of this thread is in the output and has no owner yet
  for (int d = 0; d < raster_depth; ++d) {
    const int x[3] = {corner[0] + i, corner[1] + j, corner[2] + k_first + 2 * d};
    bool within = true;
    for (int axis = 0; axis < 3; ++axis) {
      within = within && x[axis] >= job.frame.begin[axis] && x[axis] < job.frame.end[axis];
    }
    open |= static_cast<unsigned>(within) << d;
  }
  if (thread < 4) block_counts[thread] = 0;

  for (std::uint32_t first = range.begin; first < range.end; first += raster_chunk) {
    const int count = static_cast<int>(min_of(range.end - first, std::uint32_t{raster_chunk}));
    __syncthreads();  // everybody has finished with the chunk before
    load_chunk(job, first, count, corner, chunk);
    __syncthreads();
    for (int d = 0; d < raster_depth; ++d) {
      const int k = k_first + 2 * d;
      if ((open >> d & 1) == 0) continue;
      const int slot = find_owner(job, chunk, count, corner, i, j, k, mine);
      if (slot < 0) continue;
      open &= ~(1u << d);
      ++mine.covered;
      const int t = chunk.tet[slot];
      const std::int64_t voxel = job.frame.offset_of(corner[0] + i, corner[1] + j, corner[2] + k);
      const bool transformed = General && has_transform(job, t);
      mine.copied += chunk.copied[slot] && !transformed;
      if (work >= 0) {
        store_filled(job, work, voxel);
      } else if (transformed) {
        store_transformed_voxel(job, t, corner, i, j, k, voxel);
      } else if ((General || sizeof(Real) == 4) && chunk.alone[slot]) {
        store_owned<General, T, double>(job, t, corner[0], corner[1], corner[2], i, j, k, voxel);
      } else {
        store_sample<General>(job, chunk.copied[slot] ? Filter::nearest : job.filter,
                              chunk.maps[slot], i, j, k, voxel);
      }
      if (job.mask != nullptr) job.mask[voxel] = 1;
      if (job.tet != nullptr) job.tet[voxel] = t;
    }
  }
  for (int d = 0; d < raster_depth; ++d) {
    if ((open >> d & 1) == 0) continue;
    const int k = k_first + 2 * d;
    const std::int64_t voxel = job.frame.offset_of(corner[0] + i, corner[1] + j, corner[2] + k);
    if (General && has_outside_transform(job)) {
      store_transformed_outside(job, corner, i, j, k, voxel);
    } else {
      store_outside<General>(job, corner[0], corner[1], corner[2], i, j, k, voxel);
    }
    if (job.mask != nullptr) job.mask[voxel] = 0;
    if (job.tet != nullptr) job.tet[voxel] = -1;
  }

  __syncthreads();
  atomicAdd(&block_counts[0], static_cast<int>(mine.covered));
  atomicAdd(&block_counts[1], static_cast<int>(mine.inside_tests));
  atomicAdd(&block_counts[2], static_cast<int>(mine.exact_tests));
  atomicAdd(&block_counts[3], static_cast<int>(mine.copied));
  __syncthreads();
  if (job.cell_covered.size > 0 && thread == 0) {
    job.cell_covered[cell] = static_cast<std::uint16_t>(block_counts[0]);
  }
  if (job.counts != nullptr && thread < 4 && block_counts[thread] != 0) {
    atomic_add(reinterpret_cast<std::int64_t*>(job.counts) + thread, block_counts[thread]);
  }
}

/// The kernel for a job: wide filters, transforms and hexahedra have their own, whose registers the
/// others need not pay for.
template <class T>
auto raster_kernel(const RasterJob<T>& job) {
  const bool is_plain =
      !is_wide(job.filter) && job.transforms.size == 0 && job.hexes.nodes.size == 0;
  return is_plain ? cell_raster_kernel<T, false> : cell_raster_kernel<T, true>;
}

}  // namespace tetwarp

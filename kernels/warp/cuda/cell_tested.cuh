/// @file cell_tested.cuh
/// Stage "raster" of the warp as a CUDA kernel, for cells that are not interior. Cells of several
/// tetrahedra whose samples all lie in the source have tests as in cell_raster.cuh and samples
/// without clamps and switches; the others are computed as there.
#pragma once
#include "kernels/exec/async_copy.cuh"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/interior_sample.hpp"

namespace tetwarp {

/// A cell of class `tested` and its tetrahedra, in shared memory.
struct TestedChunk {
  TestedCell cell;
  PairRecord pairs[most_tested_pairs];
};
static_assert(sizeof(TestedChunk) <= raster_threads * copy_bytes);

/// Minimum blocks per multiprocessor: raster_blocks(), but four before sm_80, where copies to
/// shared memory pass through registers. With these none spills.
template <class T>
constexpr int tested_blocks() {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
  return 4;
#else
  return raster_blocks<T, false>();
#endif
}

/// Begins to copy a cell and its records to shared memory. Called by all threads of a block.
/// @param units  address of this thread's part of the first unit
__device__ __forceinline__ void begin_tested(const std::byte* units,
                                             const RecordRange& range,
                                             TestedChunk& chunk) {
  constexpr std::uint32_t unit_copies = sizeof(RecordUnit) / copy_bytes;
  if (threadIdx.x < range.units * unit_copies) {
    begin_copy(reinterpret_cast<std::byte*>(&chunk) + threadIdx.x * copy_bytes,
               units + std::size_t{range.first} * sizeof(RecordUnit));
  }
}

/// find_owners() among the records of a cell.
/// @param row  the bit at row_bit(j)
template <class T>
__device__ __forceinline__ std::uint32_t tested_owners(const RasterJob<T>& job,
                                                       const TestedChunk& chunk,
                                                       int i,
                                                       int j,
                                                       int k_first,
                                                       std::uint32_t row,
                                                       VoxelBits& open,
                                                       ThreadCounts& mine) {
  const int count = chunk.cell.pairs;
  std::uint32_t slots = 0;
  for (int slot = 0; slot < count && open != 0; ++slot) {
    const PairRecord& pair = chunk.pairs[slot];
    const std::uint32_t voxels = pair.map.voxels;
    VoxelBits inside = open;
    if ((voxels & accepted_voxels) == 0) {
      const VoxelBits tested = (voxels & row) != 0 ? voxels >> k_first & open : 0;
      if (tested == 0) continue;
      inside =
          inside_of(job, pair.planes, pair.map.tet, chunk.cell.corner, i, j, k_first, tested, mine);
    }
    slots |= inside * static_cast<unsigned>(slot);
    open &= ~inside;
  }
  return slots;
}

/// Computes the voxels of a cell. Those that no tetrahedron covers are sampled by the map of the
/// first one, which stays in the source too, and stored as background. Called by all threads of a
/// block.
/// @param row      as above
/// @param covered  shared, the number of covered voxels is added to it
template <class T>
__device__ __forceinline__ void tested_cell(const RasterJob<T>& job,
                                            const TestedChunk& chunk,
                                            std::uint32_t row,
                                            ThreadCounts& mine,
                                            int* covered) {
  const int thread = static_cast<int>(threadIdx.x);
  const int i = thread & 7, j = thread >> cell_shift & 7, k_first = thread >> 2 * cell_shift;
  VoxelBits open = all_voxels;
  const std::uint32_t slots = tested_owners(job, chunk, i, j, k_first, row, open, mine);
  const int found = raster_depth - __popc(open);
  mine.covered += found;
  atomicAdd(covered, found);
  const SourceSteps steps(job.source.dims);
  InteriorTap taps[raster_depth];
  SampleCube<T> cubes[raster_depth];
  for (int d = 0; d < raster_depth; ++d) {
    const PairMap& map = chunk.pairs[slot_of(slots, d)].map;
    float x[3];
    local_position(map, i, j, k_first + 2 * d, x);
    taps[d] = interior_tap(x);
    const T* const source = static_cast<const T*>(map.source);
    cubes[d] = steps.cube(kept(source + steps.offset_of(taps[d])));
  }
  const int width = job.frame.end[0] - job.frame.begin[0];
  const int slice = width * (job.frame.end[1] - job.frame.begin[1]);
  const std::int64_t first = chunk.cell.output + (j * width + i);
  T* const out = job.volume + first;
  for (int d = 0; d < raster_depth; ++d) {
    const int at = (k_first + 2 * d) * slice;
    const bool is_covered = !has_voxel(open, d);
    const T value = kept(interior_value(cubes[d], taps[d]));  // all of them without branches
    out[at] = is_covered ? value : job.background;
  }
  if (job.mask == nullptr && job.tet == nullptr) return;
  for (int d = 0; d < raster_depth; ++d) {
    const std::int64_t at = first + (k_first + 2 * d) * slice;
    const bool is_covered = !has_voxel(open, d);
    if (job.mask != nullptr) job.mask[at] = is_covered;
    if (job.tet != nullptr) {
      job.tet[at] = is_covered ? chunk.pairs[slot_of(slots, d)].map.tet : -1;
    }
  }
}

/// Computes the listed cells of class `tested` that fall to this block. While one is computed the
/// next one is copied to shared memory. Called by all threads of a block.
/// @param chunks        shared, two
/// @param covered       shared, two: covered voxels of the cells in `chunks`
/// @param block_counts  shared, four
/// @returns  the number of the block's next cell, after the list
template <class T>
__device__ __forceinline__ int tested_cells(const RasterJob<T>& job,
                                            const CellLists& lists,
                                            TestedChunk* chunks,
                                            int* covered,
                                            int* block_counts) {
  const int thread = static_cast<int>(threadIdx.x);
  const int step = static_cast<int>(gridDim.x), count = lists.counts->tested;
  int at = static_cast<int>(blockIdx.x);
  if (at >= count) return at;
  if (thread < 4) block_counts[thread] = 0;
  if (thread < 2) covered[thread] = 0;
  ThreadCounts mine = {0, 0, 0, 0};
  const std::uint32_t row = kept(1u << row_bit(thread >> cell_shift & 7));
  const std::byte* const units = kept(lists.units->bytes + thread * copy_bytes);
  begin_tested(units, lists.tested[at], chunks[0]);
  RecordRange next = {0, 0};  // the cell to copy next
  if (at + step < count) next = lists.tested[at + step];
  std::int64_t before = -1;  // the cell before
  int half = 0;
  const auto store_covered = [&] {
    if (thread != 0 || before < 0) return;
    const int sum = covered[half ^ 1];
    covered[half ^ 1] = 0;
    if (job.cell_covered.size > 0) job.cell_covered[before] = static_cast<std::uint16_t>(sum);
  };
  for (; at < count; at += step) {
    wait_for_copies();
    __syncthreads();  // this cell is there, the one before is done
    store_covered();
    begin_tested(units, next, chunks[half ^ 1]);
    next = {0, 0};
    if (at + 2 * step < count) next = lists.tested[at + 2 * step];
    before = chunks[half].cell.cell;
    tested_cell(job, chunks[half], row, mine, &covered[half]);
    half ^= 1;
  }
  __syncthreads();
  store_covered();
  add_counts(job, blockIdx.x, mine, block_counts);
  return at;
}

/// Computes the listed cells of class `tested`, then those of class `general`.
///
/// Blocks: any number, which share the lists; best as many as are resident. Threads:
/// raster_threads. Shared: two TestedChunk, one RasterChunk, six counters, 6.0 KiB.
/// @param with_general  false: cells of class `general` are left out, as those of hexahedra must be
template <class T>
__global__ void __launch_bounds__(raster_threads, tested_blocks<T>())
    cell_tested_kernel(RasterJob<T> job, CellLists lists, bool with_general) {
  __shared__ TestedChunk chunks[2];
  __shared__ RasterChunk<float> general_chunk;
  __shared__ int covered[2];
  __shared__ int block_counts[4];

  const int first = tested_cells(job, lists, chunks, covered, block_counts);
  if (!with_general) return;
  const int general = lists.counts->general;
  for (int at = first - lists.counts->tested; at < general; at += static_cast<int>(gridDim.x)) {
    raster_cell<false>(job, lists.general[at], general_chunk, block_counts);
  }
}

}  // namespace tetwarp

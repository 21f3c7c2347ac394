/// @file cell_interior.cuh
/// Stage "raster" of the warp as CUDA kernels, for cells within one tetrahedron: interpolates their
/// voxels with nothing left to decide.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/interior_sample.hpp"

namespace tetwarp {

constexpr int interior_threads = 128;
constexpr int interior_warps = interior_threads / 32;
constexpr int interior_flight = 4;  ///< voxels of a thread whose samples are loaded together

/// Minimum blocks per multiprocessor: eight leave 64 registers, too few for samples of 8 and 16
/// bits, whose addresses take more instructions, and for sm_120. With these none spills.
template <class T>
constexpr int interior_blocks() {
  if (sizeof(T) < 4) return 5;
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 1200
  return 7;
#else
  return 8;
#endif
}

/// Stores the samples of the listed interior cells.
///
/// A warp takes four rows of eight voxels in eight slices of a cell, a thread eight voxels along k.
/// Blocks: any number, which share the list. Threads: interior_threads.
template <class T>
__global__ void __launch_bounds__(interior_threads, interior_blocks<T>())
    cell_interior_kernel(RasterJob<T> job,
                         const InteriorCell* cells,
                         const CellListCounts* counts) {
  const int count = counts->interior;
  const int thread = static_cast<int>(threadIdx.x), warp = thread / 32;
  const int i = thread & 7, j = thread >> cell_shift & 3;
  const int width = job.frame.end[0] - job.frame.begin[0];
  const int slice = width * (job.frame.end[1] - job.frame.begin[1]);
  if (blockIdx.x == 0 && thread == 0 && job.counts != nullptr) {
    atomic_add(&job.counts->covered, std::int64_t{count} * cell_edge * cell_edge * cell_edge);
  }
  for (int half = static_cast<int>(blockIdx.x) * interior_warps + warp; half < 2 * count;
       half += static_cast<int>(gridDim.x) * interior_warps) {
    const InteriorCell& cell = cells[half / 2];
    const int row = j + half % 2 * 4;
    const PairMap map = cell.map;
    const InteriorSource<T> source(static_cast<const T*>(map.source), job.source.dims, thread);
    const std::int64_t first = cell.output + (row * width + i);
    T* const out = job.volume + first;
    for (int k = 0; k < cell_edge; k += interior_flight) {
      InteriorTap taps[interior_flight];
      SampleCube<T> cubes[interior_flight];
      for (int v = 0; v < interior_flight; ++v) {
        float x[3];
        local_position(map, static_cast<float>(i), static_cast<float>(row),
                       static_cast<float>(k + v), x);
        taps[v] = interior_tap(x);
        cubes[v] = source.cube(taps[v]);
      }
      for (int v = 0; v < interior_flight; ++v) {
        out[(k + v) * slice] = interior_value(cubes[v], taps[v]);
      }
    }
  }
}

/// Stores mask and owners of the listed interior cells. Blocks and threads as above.
template <class T>
__global__ void __launch_bounds__(interior_threads)
    cell_owner_kernel(RasterJob<T> job, const InteriorCell* cells, const CellListCounts* counts) {
  constexpr int voxels = cell_edge * cell_edge * cell_edge;
  const int width = job.frame.end[0] - job.frame.begin[0];
  const int slice = width * (job.frame.end[1] - job.frame.begin[1]);
  for (int c = static_cast<int>(blockIdx.x); c < counts->interior;
       c += static_cast<int>(gridDim.x)) {
    for (int v = static_cast<int>(threadIdx.x); v < voxels; v += interior_threads) {
      const std::int64_t at = cells[c].output + (v % cell_edge + v / cell_edge % cell_edge * width +
                                                 v / (cell_edge * cell_edge) * slice);
      if (job.mask != nullptr) job.mask[at] = 1;
      if (job.tet != nullptr) job.tet[at] = cells[c].map.tet;
    }
  }
}

}  // namespace tetwarp

/// @file cell_interior.cuh
/// Stage "raster" of the warp as CUDA kernels, for cells within one tetrahedron: lists them, and
/// interpolates their voxels with nothing left to decide.
#pragma once
#include "kernels/exec/launch.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/cell_work.hpp"
#include "kernels/warp/interior_sample.hpp"

namespace tetwarp {

constexpr int class_threads = 128;
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

/// The place in a list of this lane's item; one atomic addition per warp. All lanes of the warp
/// call it.
__device__ __forceinline__ int place_in_list(bool has_item, std::int32_t* count) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const unsigned items = __ballot_sync(0xffffffffu, has_item);
  int first = 0;
  if (lane == 0 && items != 0) first = atomicAdd(count, __popc(items));
  first = __shfl_sync(0xffffffffu, first, 0);
  return first + __popc(items & ((1u << lane) - 1));
}

/// Chooses the work of each cell where that is to be done, and lists cells by class. The order of a
/// list depends on the device's scheduling; each cell is written on its own, so that the output
/// does not.
///
/// Blocks: one per class_threads cells. Threads: class_threads.
/// @param counts  zeros
template <class T>
__global__ void __launch_bounds__(class_threads) cell_class_kernel(CellWorkBody<T> work,
                                                                   InteriorCell* interior,
                                                                   std::uint32_t* tested,
                                                                   std::uint32_t* general,
                                                                   CellListCounts* counts) {
  const RasterJob<T>& job = work.job;
  const std::int64_t cell =
      std::int64_t{blockIdx.x} * class_threads + static_cast<int>(threadIdx.x);
  InteriorCell record = {};
  CellClass found = CellClass::keep;
  if (cell < job.frame.cell_count()) {
    if (cell < work.work.size) work(cell);
    found = class_of(job, cell, record);
  }
  const int at_interior = place_in_list(found == CellClass::interior, &counts->interior);
  const int at_tested = place_in_list(found == CellClass::tested, &counts->tested);
  const int at_general = place_in_list(found == CellClass::general, &counts->general);
  if (found == CellClass::interior) {
    interior[at_interior] = record;
    if (job.cell_covered.size > 0) job.cell_covered[cell] = cell_edge * cell_edge * cell_edge;
  } else if (found == CellClass::tested) {
    tested[at_tested] = static_cast<std::uint32_t>(cell);
  } else if (found == CellClass::general) {
    general[at_general] = static_cast<std::uint32_t>(cell);
  }
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
  const int i = thread % cell_edge, j = thread / cell_edge % 4;
  const int width = job.frame.end[0] - job.frame.begin[0];
  const int slice = width * (job.frame.end[1] - job.frame.begin[1]);
  if (blockIdx.x == 0 && thread == 0 && job.counts != nullptr) {
    atomic_add(&job.counts->covered, std::int64_t{count} * cell_edge * cell_edge * cell_edge);
  }
  for (int half = static_cast<int>(blockIdx.x) * interior_warps + warp; half < 2 * count;
       half += static_cast<int>(gridDim.x) * interior_warps) {
    const InteriorCell& cell = cells[half / 2];
    const int row = j + half % 2 * 4;
    SourceMap<float> map;
    for (int r = 0; r < 3; ++r) {
      map.base[r] = cell.base[r];
      for (int axis = 0; axis < 3; ++axis) map.axis[axis][r] = cell.axis[axis][r];
    }
    const InteriorSource<T> source(job.source.data + cell.source, job.source.dims, thread);
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
      if (job.tet != nullptr) job.tet[at] = cells[c].tet;
    }
  }
}

}  // namespace tetwarp

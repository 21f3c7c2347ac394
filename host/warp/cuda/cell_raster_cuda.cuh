/// @file cell_raster_cuda.cuh
/// Stage "raster" on a device. The first kernel chooses the work of the cells and lists them by
/// class; cells within one tetrahedron have a kernel of their own, all others another one.
/// @see cell_class.cuh, cell_interior.cuh, cell_tested.cuh, cell_raster.cuh
#pragma once
#include <type_traits>

#include "host/warp/warp_pipeline.hpp"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/warp/cuda/cell_class.cuh"
#include "kernels/warp/cuda/cell_interior.cuh"
#include "kernels/warp/cuda/cell_raster.cuh"
#include "kernels/warp/cuda/cell_tested.cuh"

namespace tetwarp {

/// All cells of a job, or those that it lists.
template <class T>
void cell_raster(CudaExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  const dim3 cells(static_cast<unsigned>(job.frame.cell_count()));
  exec.enqueue("warp/raster", raster_kernel(job), cells, raster_threads, 0, job);
  progress.report(1.0);
}

/// The lists of cells by class; kept from step to step.
template <>
class CellRaster<CudaExec> {
 public:
  template <class T>
  void run(CudaExec& exec,
           const CellWorkBody<T>& work,
           bool has_classes,
           CellListCounts* counts,
           const ProgressPart& progress) {
    if constexpr (can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
      if (has_classes && has_interior_cells(work.job)) {
        run_classes(exec, work, counts, progress);
        return;
      }
    }
    cell_work(exec, work);
    cell_raster(exec, work.job, progress);
  }

 private:
  static dim3 blocks_of(std::int64_t count) { return dim3(static_cast<unsigned>(count)); }

  /// Blocks that fit a large device at once: they share the list of cells.
  static constexpr std::int64_t most_blocks = 132 * 8;

  template <class T>
  static T* view_of(DeviceBuffer<T>& buffer, std::int64_t size) {
    buffer.reserve(size);
    return buffer.view(size).data;
  }

  /// Blocks of cell_tested_kernel() that the device runs at a time.
  template <class T>
  std::int64_t tested_grid(const CudaExec& exec) {
    std::int64_t& blocks = tested_grids_[sizeof(T)][std::is_signed_v<T>];
    if (blocks == 0) {
      int of_one = 0;  // multiprocessor
      check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&of_one, cell_tested_kernel<T>,
                                                               raster_threads, 0),
                 "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
      blocks = of_one * device_limits(exec.number()).multiprocessors;
    }
    return blocks;
  }

  template <class T>
  void run_classes(CudaExec& exec,
                   const CellWorkBody<T>& work,
                   CellListCounts* counts,
                   const ProgressPart& progress) {
    RasterJob<T> job = work.job;
    const std::int64_t cells = job.frame.cell_count();
    const char* const label = "warp/raster";
    if (counts == nullptr) {
      counts_.reserve(1);
      counts = counts_.view(1).data;
      exec.zero(label, counts_.view(1));
    }
    const std::int64_t units = most_units(cells, job.pairs.size);
    const CellLists lists{view_of(interior_, cells), view_of(tested_, cells),
                          view_of(units_, units), view_of(general_, cells), counts};
    exec.enqueue(label, cell_class_kernel<T>, blocks_of((cells + class_cells - 1) / class_cells),
                 class_threads, 0, work, lists);
    const dim3 blocks = blocks_of(min_of(2 * cells, most_blocks));
    exec.enqueue(label, cell_interior_kernel<T>, blocks, interior_threads, 0, job, lists.interior,
                 counts);
    if (job.mask != nullptr || job.tet != nullptr) {
      exec.enqueue(label, cell_owner_kernel<T>, blocks, interior_threads, 0, job, lists.interior,
                   counts);
    }
    const bool has_hexes = job.hexes.nodes.size > 0;
    exec.enqueue(label, cell_tested_kernel<T>, blocks_of(min_of(cells, tested_grid<T>(exec))),
                 raster_threads, 0, job, lists, !has_hexes);
    if (has_hexes) {
      job.listed = lists.general;
      job.listed_count = &counts->general;
      cell_raster(exec, job, progress);
    }
    progress.report(1.0);
  }

  DeviceBuffer<InteriorCell> interior_;
  DeviceBuffer<RecordRange> tested_;
  DeviceBuffer<RecordUnit> units_;
  DeviceBuffer<std::uint32_t> general_;
  DeviceBuffer<CellListCounts> counts_;
  std::int64_t tested_grids_[sizeof(float) + 1][2] = {};  ///< by size and sign of T; 0: unknown
};

}  // namespace tetwarp

/// @file cell_raster_cuda.cuh
/// Stage "raster" on a device: cells within one tetrahedron by a lean kernel, the others by one
/// block per cell. The first kernel chooses the work of the cells and lists them by class.
/// @see cell_interior.cuh, cell_raster.cuh
#pragma once
#include "host/warp/warp_pipeline.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/warp/cell_interior.cuh"
#include "kernels/warp/cell_raster.cuh"
#include "kernels/warp/cell_tested.cuh"

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
  void run_classes(CudaExec& exec,
                   const CellWorkBody<T>& work,
                   CellListCounts* counts,
                   const ProgressPart& progress) {
    RasterJob<T> job = work.job;
    const std::int64_t cells = job.frame.cell_count();
    interior_.reserve(cells);
    tested_.reserve(cells);
    general_.reserve(cells);
    InteriorCell* const interior = interior_.view(cells).data;
    std::uint32_t* const tested = tested_.view(cells).data;
    std::uint32_t* const general = general_.view(cells).data;
    const char* const label = "warp/raster";
    if (counts == nullptr) {
      counts_.reserve(1);
      counts = counts_.view(1).data;
      exec.zero(label, counts_.view(1));
    }
    exec.enqueue(label, cell_class_kernel<T>,
                 blocks_of((cells + class_threads - 1) / class_threads), class_threads, 0, work,
                 interior, tested, general, counts);
    const dim3 blocks = blocks_of(min_of(2 * cells, most_blocks));
    exec.enqueue(label, cell_interior_kernel<T>, blocks, interior_threads, 0, job, interior,
                 counts);
    if (job.mask != nullptr || job.tet != nullptr) {
      exec.enqueue(label, cell_owner_kernel<T>, blocks, interior_threads, 0, job, interior, counts);
    }
    const bool has_hexes = job.hexes.nodes.size > 0;
    exec.enqueue(label, cell_tested_kernel<T>, blocks_of(cells), raster_threads, 0, job, tested,
                 has_hexes ? nullptr : general, counts);
    if (has_hexes) {
      job.listed = general;
      job.listed_count = &counts->general;
      cell_raster(exec, job, progress);
    }
    progress.report(1.0);
  }

  DeviceBuffer<InteriorCell> interior_;
  DeviceBuffer<std::uint32_t> tested_, general_;
  DeviceBuffer<CellListCounts> counts_;
};

}  // namespace tetwarp

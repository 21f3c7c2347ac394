/// @file cell_raster_cuda.cuh
/// Stage "raster" on a device: cells within one tetrahedron by a lean kernel, the others by one
/// block per cell.
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
  void run(CudaExec& exec, RasterJob<T> job, bool has_classes, const ProgressPart& progress) {
    if constexpr (can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
      if (has_classes && has_interior_cells(job)) run_interior(exec, job);
    }
    cell_raster(exec, job, progress);
  }

 private:
  static dim3 blocks_of(std::int64_t count) { return dim3(static_cast<unsigned>(count)); }

  /// Blocks that fit a large device at once: they share the list of cells.
  static constexpr std::int64_t most_blocks = 132 * 8;

  /// Computes the interior cells and lists the others in `job`.
  template <class T>
  void run_interior(CudaExec& exec, RasterJob<T>& job) {
    const std::int64_t cells = job.frame.cell_count();
    interior_.reserve(cells);
    tested_.reserve(cells);
    general_.reserve(cells);
    counts_.reserve(1);
    InteriorCell* const interior = interior_.view(cells).data;
    std::uint32_t* const tested = tested_.view(cells).data;
    std::uint32_t* const general = general_.view(cells).data;
    CellListCounts* const counts = counts_.view(1).data;
    const char* const label = "warp/raster";
    exec.zero(label, counts_.view(1));
    exec.enqueue(label, cell_class_kernel<T>,
                 blocks_of((cells + class_threads - 1) / class_threads), class_threads, 0, job,
                 interior, tested, general, counts);
    const dim3 blocks = blocks_of(min_of(2 * cells, most_blocks));
    exec.enqueue(label, cell_interior_kernel<T>, blocks, interior_threads, 0, job, interior,
                 counts);
    if (job.mask != nullptr || job.tet != nullptr) {
      exec.enqueue(label, cell_owner_kernel<T>, blocks, interior_threads, 0, job, interior, counts);
    }
    exec.enqueue(label, cell_tested_kernel<T>, blocks_of(cells), raster_threads, 0, job, tested,
                 counts);
    job.listed = general;
    job.listed_count = &counts->general;
  }

  DeviceBuffer<InteriorCell> interior_;
  DeviceBuffer<std::uint32_t> tested_, general_;
  DeviceBuffer<CellListCounts> counts_;
};

}  // namespace tetwarp

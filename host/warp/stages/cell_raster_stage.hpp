/// @file cell_raster_stage.hpp
/// Stage "raster" of the warp as the pipeline calls it.
#pragma once
#include "host/warp/geometry.hpp"
#include "host/warp/step_counters.hpp"
#include "kernels/warp/cell_work.hpp"

namespace tetwarp {

/// Stage "raster" of an executor, and what it keeps from step to step. Back end cuda specializes
/// it: host/warp/cuda/cell_raster_cuda.cuh.
template <class Exec>
class CellRaster {
 public:
  /// Chooses the work of the cells and computes them.
  /// @param has_classes  whether cells within one tetrahedron may take a path of their own
  /// @param counts       numbers of cells by class, zeros; null: the executor clears its own
  template <class T>
  void run(Exec& exec,
           const CellWorkOp<T>& work,
           bool /*has_classes*/,
           CellListCounts* /*counts*/,
           const ProgressPart& progress) {
    cell_work(exec, work);
    cell_raster(exec, work.job, progress);
  }
};

}  // namespace tetwarp

/// @file cell_raster_stage.hpp
/// Stage "raster" of the warp as the pipeline calls it.
#pragma once
#include "host/warp/geometry.hpp"
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// Stage "raster" of an executor, and what it keeps from step to step. Back end cuda specializes
/// it: host/warp/cuda/cell_raster_cuda.cuh.
template <class Exec>
class CellRaster {
 public:
  /// @param has_classes  whether cells within one tetrahedron may take a path of their own
  template <class T>
  void run(Exec& exec, const RasterJob<T>& job, bool, const ProgressPart& progress) {
    cell_raster(exec, job, progress);
  }
};

}  // namespace tetwarp

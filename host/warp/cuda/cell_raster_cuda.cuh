/// @file cell_raster_cuda.cuh
/// Stage "raster" on a device: one block per cell.
/// @see cell_raster.cuh
#pragma once
#include "host/warp/warp_pipeline.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/warp/cell_raster.cuh"

namespace tetwarp {

template <class T>
void cell_raster(CudaExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  const dim3 cells(static_cast<unsigned>(job.frame.cell_count()));
  exec.timed("warp/raster",
             [&] { launch(exec.stream(), raster_kernel(job), cells, raster_threads, 0, job); });
  progress.report(1.0);
}

}  // namespace tetwarp

/// @file cell_raster_cpu.hpp
/// Stage "raster" on host threads: a line of cells per thread, a row of eight voxels per vector.
#pragma once
#include "host/exec/exec_cpu.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// cell_raster() below, of a RasterJob of pixel type `type`.
void cell_raster(CpuExec& exec,
                 PixelType type,
                 const RasterGeometry& job,
                 const ProgressPart& progress);

/// Writes every voxel of the output once. The same bits as the body of cell_raster.hpp, for any
/// vector width (Highway selects it at run time) and any number of threads.
///
/// @param exec      threads and clock
/// @param job       see RasterJob; job.counts may be null
/// @param progress  called between batches of cell lines
/// @throws Cancelled when `progress` returns false
template <class T>
void cell_raster(CpuExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  cell_raster(exec, pixel_type_of<T>(), job, progress);
}

}  // namespace tetwarp

/// @file cell_raster_cpu.hpp
/// Stage "raster" on host threads: one thread owns a line of cells, a vector a row of eight voxels.
#pragma once
#include "host/exec/exec_cpu.hpp"
#include "host/warp/geometry.hpp"
#include "kernels/warp/cell_raster.hpp"

namespace tetwarp {

/// Writes every voxel of the output once. Same bits as the body of cell_raster.hpp, whatever the
/// vector width (Highway picks it at run time) and the number of threads.
///
/// @param exec      threads and clock
/// @param job       see RasterJob; job.counts may be null
/// @param progress  told between batches of cell lines; may throw Cancelled
template <class T>
void cell_raster(CpuExec& exec, const RasterJob<T>& job, const ProgressPart& progress);

}  // namespace tetwarp

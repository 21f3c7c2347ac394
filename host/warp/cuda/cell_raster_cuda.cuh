/// @file cell_raster_cuda.cuh
/// Stage "raster" on a device. One kernel computes most cells of plain images and lists the others,
/// which a second one computes; any other job has the second one alone.
/// @see cell_group.cuh, cell_raster.cuh
#pragma once
#include "host/warp/stages/warp_pipeline.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/warp/cuda/cell_group.cuh"
#include "kernels/warp/cuda/cell_raster.cuh"

namespace tetwarp {

/// Blocks of cell_raster_kernel() that share a list: as many as a large device holds at once.
constexpr std::int64_t most_list_blocks = 132 * 5;

/// All cells of a job, or those that it lists.
template <class T>
void cell_raster(CudaExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  const std::int64_t cells = job.frame.cell_count();
  const std::int64_t blocks = job.listed != nullptr ? min_of(cells, most_list_blocks) : cells;
  exec.enqueue("warp/raster", raster_kernel(job), dim3(static_cast<unsigned>(blocks)),
               raster_threads, 0, job);
  progress.report(1.0);
}

/// The list of cells that are not plain; kept from step to step.
template <>
class CellRaster<CudaExec> {
 public:
  template <class T>
  void run(CudaExec& exec,
           const CellWorkOp<T>& work,
           bool has_groups,
           CellListCounts* counts,
           const ProgressPart& progress) {
    cell_work(exec, work);
    if constexpr (can_blend<T> && sizeof(ArithmeticOf<T>) == 4) {
      if (has_groups && has_plain_cells(work.job)) {
        run_groups(exec, work.job, counts, progress);
        return;
      }
    }
    cell_raster(exec, work.job, progress);
  }

 private:
  /// Maps of a cell that have room: one and a half times the mean number of pairs; at least enough
  /// for a node of the mesh and all tetrahedra around it, at most what leaves a multiprocessor
  /// eight blocks.
  static int capacity(const RasterGeometry& job) {
    constexpr std::int64_t least = 39, most = 63;
    const std::int64_t pairs = job.usual_pairs > 0 ? job.usual_pairs : job.pairs.size;
    return static_cast<int>(min_of(max_of(3 * pairs / (2 * job.frame.cell_count()), least), most));
  }

  template <class T>
  void run_groups(CudaExec& exec,
                  RasterJob<T> job,
                  CellListCounts* counts,
                  const ProgressPart& progress) {
    const char* const label = "warp/raster";
    const OutputFrame& frame = job.frame;
    const std::int64_t cells = frame.cell_count();
    if (counts == nullptr) {
      counts_.reserve(1);
      counts = counts_.view(1).data;
      exec.zero(label, counts_.view(1));
    }
    general_.reserve(cells);
    std::uint32_t* const general = general_.view(cells).data;
    const dim3 groups(static_cast<unsigned>((frame.cells[0] + group_cells - 1) / group_cells),
                      static_cast<unsigned>(frame.cells[1]), static_cast<unsigned>(frame.cells[2]));
    const int room = capacity(job);
    const auto enqueue = [&](auto* kernel) {
      exec.enqueue(label, kernel, groups, group_threads, group_bytes(room), job, room, general,
                   &counts->general);
    };
    if (job.packed != nullptr) {
      enqueue(cell_group_kernel<T, PackedSample<T>>);
    } else {
      enqueue(cell_group_kernel<T, T>);
    }
    job.listed = general;
    job.listed_count = &counts->general;
    cell_raster(exec, job, progress);
  }

  DeviceBuffer<std::uint32_t> general_;
  DeviceBuffer<CellListCounts> counts_;
};

}  // namespace tetwarp

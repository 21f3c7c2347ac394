/// @file volume_blocks.cpp
/// Limits of blocks from memory and ranks, and what to say if memory is too low.
#include "host/cli/warp/volumes/volume_blocks.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "host/base/warp_backend.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_files.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {

VolumeBlocks::VolumeBlocks(const VolumeTask& task, const Ranks& ranks)
    : task_(task), ranks_(ranks) {
  if (task.is_whole) return;
  // glibc returns the memory of a block to the system when it is freed.
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
  const MeshReader& mesh = task.job.mesh;
  planner_.emplace(task.volume.source_grid, mesh.mesh(), task.options, mesh.mid_nodes());
  fixed_bytes_ = fixed_memory(task.volume, task.arguments, mesh.header()) + curve_memory(mesh);
}

double VolumeBlocks::host_bytes() const {
  return task_.volume.memory_limit > 0 ? task_.volume.memory_limit - fixed_bytes_
                                       : std::numeric_limits<double>::infinity();
}

BlockLimits VolumeBlocks::limits() const {
  const Grid& grid = task_.volume.written_grid;
  BlockLimits limits;
  limits.host = ranks_.smallest(host_bytes());
  if (task_.job.backend == Backend::cuda) {
    limits.device = 0.9 * free_device_memory(task_.options.device);
  }
  limits.device = ranks_.smallest(limits.device);
  // With several blocks per rank the ranks finish at nearly the same time.
  constexpr std::int64_t blocks_per_rank = 4;
  if (ranks_.count() > 1) {
    limits.max_voxels = grid.voxel_count() / (blocks_per_rank * ranks_.count()) + 1;
  }
  limits.source_voxel = voxel_bytes(task_.volume.arrays);
  limits.output_voxel = voxel_bytes(task_.outputs);
  limits.scratch_voxel = owner_bytes(task_.arguments, task_.job.mesh) +
                         (task_.job.backend == Backend::reference ? 30 : 0);
  limits.step = block_step(grid, task_.outputs);
  return limits;
}

BlockPlan VolumeBlocks::plan(const std::vector<Point3>& positions,
                             const std::function<void()>& before_reading) {
  if (task_.is_whole) {
    WarpBlock whole;
    whole.output = task_.region;
    return {{whole}};
  }
  const BlockLimits allowed = limits();
  try {
    return planner_->plan(positions, allowed);
  } catch (const std::invalid_argument&) {
    if (least_block_memory(*planner_, positions, allowed) <= allowed.host) throw;
    before_reading();
    refuse(allowed);
  }
}

void VolumeBlocks::refuse(const BlockLimits& limits) {
  double least = 0;
  for (const std::int64_t step : task_.job.steps) {
    const std::vector<Point3> positions = task_.job.mesh.read_step(step);
    least = std::max(least, least_block_memory(*planner_, positions, limits));
  }
  throw std::invalid_argument(fmt::format(
      "{}: --memory is too low: the program takes {}, a block and its source {} more; give at "
      "least {}",
      task_.volume.path, bytes_text(fixed_bytes_), bytes_text(least),
      limit_text(std::min(fixed_bytes_ + least, task_.volume.memory))));
}

}  // namespace tetwarp::cli

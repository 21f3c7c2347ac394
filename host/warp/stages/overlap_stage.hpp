/// @file overlap_stage.hpp
/// Stage "raster" of a warp that keeps totals, as the pipeline calls it.
#pragma once
#include "host/warp/geometry.hpp"
#include "kernels/warp/overlap/voxel_overlap.hpp"

namespace tetwarp {

/// The stage of an executor: voxel_overlap(), which a device only queues. Back end cpu specializes
/// it: host/warp/cpu/overlap_stage_cpu.hpp.
template <class Exec>
class OverlapStage {
 public:
  /// Sets all voxels of the output.
  /// @param nodes, rest  of the mesh in both states [quantum]
  /// @param voxel_ratio  volume of a voxel of the source over that of one of the output
  void run(Exec& exec,
           const VoxelOverlapOp& op,
           View<const Node> /*nodes*/,
           View<const Node> /*rest*/,
           double /*voxel_ratio*/,
           const ProgressPart& progress) {
    voxel_overlap(exec, op, op.frame.voxel_count());
    progress.report(1.0);
  }
};

}  // namespace tetwarp

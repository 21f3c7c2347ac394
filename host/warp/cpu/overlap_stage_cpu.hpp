/// @file overlap_stage_cpu.hpp
/// Stage "raster" of a warp that keeps totals on host threads, cell by cell.
#pragma once
#include <cstdint>
#include <vector>

#include "host/exec/exec_cpu.hpp"
#include "host/warp/cpu/cell_overlap.hpp"
#include "host/warp/stages/overlap_stage.hpp"

namespace tetwarp {

/// Values as those of voxel_overlap(), to within 2^-44 of the largest sample around: the integrals
/// are the same, over facets that neighbors share. The same bits for any number of threads.
template <>
class OverlapStage<CpuExec> {
 public:
  void run(CpuExec& exec,
           const VoxelOverlapOp& op,
           View<const Node> nodes,
           View<const Node> rest,
           double voxel_ratio,
           const ProgressPart& progress);

  /// What the cells of a step read beside `op`; valid until the next call.
  OverlapMesh mesh_of(const VoxelOverlapOp& op,
                      View<const Node> nodes,
                      View<const Node> rest,
                      double voxel_ratio);

 private:
  void set_up(View<const std::int32_t> tets, View<const Node> rest);
  void set_sides(const VoxelOverlapOp& op);

  std::vector<std::int32_t> neighbors_;    ///< from face_neighbors()
  std::vector<double> rest_volumes_;       ///< six times those of the tetrahedra, signed
  std::vector<std::int8_t> sides_;         ///< see OverlapMesh
  std::vector<CellOverlapMemory> memory_;  ///< one per task
};

}  // namespace tetwarp

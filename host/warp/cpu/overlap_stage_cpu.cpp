/// @file overlap_stage_cpu.cpp
/// Runs the cells in batches between which a step reports its progress.
#include "host/warp/cpu/overlap_stage_cpu.hpp"

#include <algorithm>

#include "host/base/parallel.hpp"
#include "host/warp/cpu/face_neighbors.hpp"

namespace tetwarp {

void OverlapStage<CpuExec>::run(CpuExec& exec,
                                const VoxelOverlapOp& op,
                                View<const Node> nodes,
                                View<const Node> rest,
                                double voxel_ratio,
                                const ProgressPart& progress) {
  const OverlapMesh mesh = mesh_of(op, nodes, rest, voxel_ratio);
  const CpuExec::Clock clock(exec, "warp/raster");
  const std::int64_t cells = op.frame.cell_count(), tasks = 2 * std::int64_t{exec.threads()};
  memory_.resize(static_cast<std::size_t>(tasks));
  const std::int64_t batch = 16 * tasks;
  const double all = std::max(static_cast<double>(op.list.ranges[cells].begin), 1.0);
  for (std::int64_t begin = 0; begin < cells; begin += batch) {
    const std::int64_t end = std::min(begin + batch, cells);
    parallel_tasks(exec.threads(), tasks, [&](std::int64_t task) {
      CellOverlap overlap(op, mesh, memory_[static_cast<std::size_t>(task)]);
      for (std::int64_t cell = begin + task; cell < end; cell += tasks) overlap.run(cell);
    });
    progress.report(static_cast<double>(op.list.ranges[end].begin) / all);
  }
}

OverlapMesh OverlapStage<CpuExec>::mesh_of(const VoxelOverlapOp& op,
                                           View<const Node> nodes,
                                           View<const Node> rest,
                                           double voxel_ratio) {
  if (neighbors_.empty()) set_up(op.tets, rest);
  set_sides(op);
  return {nodes,
          rest,
          {rest_volumes_.data(), std::ssize(rest_volumes_)},
          {sides_.data(), std::ssize(sides_)},
          {neighbors_.data(), std::ssize(neighbors_)},
          voxel_ratio};
}

void OverlapStage<CpuExec>::set_up(View<const std::int32_t> tets, View<const Node> rest) {
  const std::int64_t count = tets.size / 4;
  sides_.resize(static_cast<std::size_t>(count));
  rest_volumes_.reserve(sides_.size());
  for (std::int64_t t = 0; t < count; ++t) {
    const TetNodes tet = tet_nodes(rest, tets.data + 4 * t);
    rest_volumes_.push_back(-as_double(plane_value(exact_plane(tet, 0), tet.x[0])));
  }
  neighbors_ = face_neighbors(tets, rest_volumes_);
}

void OverlapStage<CpuExec>::set_sides(const VoxelOverlapOp& op) {
  for (std::size_t t = 0; t < sides_.size(); ++t) {
    const auto index = static_cast<std::int64_t>(t);
    const TetClass tet_class = op.setups[index].tet_class;
    const bool has_shape = tet_class == TetClass::regular || tet_class == TetClass::inverted;
    const double volume = has_shape && op.transforms[index].scale > 0 ? rest_volumes_[t] : 0;
    sides_[t] = static_cast<std::int8_t>((volume > 0) - (volume < 0));
  }
}

}  // namespace tetwarp

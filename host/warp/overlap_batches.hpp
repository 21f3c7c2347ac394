/// @file overlap_batches.hpp
/// The stage that keeps totals, in batches between which a step reports its progress.
#pragma once
#include <algorithm>
#include <cstdint>

#include "host/warp/geometry.hpp"
#include "kernels/warp/voxel_overlap.hpp"

namespace tetwarp {

/// Pairs of tetrahedron and cell before a voxel: those of the layers of cells before its own, and a
/// share of its layer's. The time of the stage is about proportional to it.
inline double pairs_before(const VoxelOverlapOp& body, std::int64_t voxel) {
  const OutputFrame& frame = body.frame;
  const std::int64_t layer_voxels = std::int64_t{cell_edge} * frame.end[0] * frame.end[1];
  const std::int64_t layer_cells = std::int64_t{frame.cells[0]} * frame.cells[1];
  const std::int64_t layer = voxel / layer_voxels;
  if (layer >= frame.cells[2]) {
    return static_cast<double>(body.list.ranges[frame.cell_count()].begin);
  }
  const auto begin = static_cast<double>(body.list.ranges[layer * layer_cells].begin);
  const auto end = static_cast<double>(body.list.ranges[(layer + 1) * layer_cells].begin);
  const std::int64_t past = std::min((layer + 1) * layer_voxels, frame.voxel_count());
  const auto done = static_cast<double>(voxel - layer * layer_voxels);
  return begin + (end - begin) * done / static_cast<double>(past - layer * layer_voxels);
}

/// voxel_overlap() of all voxels. On the host it reports after each batch; on a device the stage is
/// only queued and reports once.
/// @throws Cancelled when the progress callback returns false
template <class Exec>
void overlap_in_batches(Exec& exec, VoxelOverlapOp body, const ProgressPart& progress) {
  constexpr std::int64_t batch = std::int64_t{1} << 17;  // voxels: tenths of a second
  const std::int64_t voxels = body.frame.voxel_count();
  if (Exec::reads_are_free && progress.is_requested()) {
    const double all = std::max(pairs_before(body, voxels), 1.0);
    for (; body.first + batch < voxels; body.first += batch) {
      voxel_overlap(exec, body, batch);
      progress.report(pairs_before(body, body.first + batch) / all);
    }
  }
  voxel_overlap(exec, body, voxels - body.first);
  progress.report(1.0);
}

}  // namespace tetwarp

/// @file overlap_weights.cpp
/// Takes the parts of the surfaces of a cell's bodies from CellOverlap, and integrates them without
/// samples.
#include "host/warp/cpu/overlap_weights.hpp"

#include <algorithm>
#include <tuple>

#include "host/base/parallel.hpp"
#include "host/warp/cpu/overlap_stage_cpu.hpp"
#include "host/warp/stages/pairs_host.hpp"
#include "host/warp/stages/transforms.hpp"

namespace tetwarp {

OverlapWeights::OverlapWeights(const WarpPlan& plan,
                               const std::vector<Point3>& deformed,
                               const std::vector<std::uint8_t>& mask,
                               int threads)
    : dims_(plan.sources.front().grid.dims) {
  const WarpGeometry geometry = make_geometry(plan);
  frame_ = geometry.frame;
  CpuExec exec(threads, StageClocks::off);
  HostPairs<CpuExec> pairs(exec, plan, geometry);
  pairs.run({deformed.front().data(), 3 * std::ssize(deformed)});
  WarpTransforms<CpuExec> transforms(exec, plan, geometry);
  transforms.run(pairs);
  VoxelOverlapOp op{};
  op.setups = pairs.setups();
  op.tets = pairs.tets();
  op.transforms = transforms.transforms(0, pairs.tet_count());
  op.list = pairs.list();
  op.frame = frame_;
  for (std::size_t axis = 0; axis < 3; ++axis) op.dims[axis] = static_cast<int>(dims_[axis]);
  op.components = 1;
  OverlapStage<CpuExec> stage;
  const double voxel_ratio = voxel_ratio_of(geometry.axes);
  const OverlapMesh mesh = stage.mesh_of(op, pairs.nodes(), pairs.rest(), voxel_ratio);
  cells_.resize(static_cast<std::size_t>(frame_.cell_count()));
  const std::int64_t tasks = 4 * std::int64_t{threads};
  parallel_tasks(threads, tasks, [&](std::int64_t task) {
    CellOverlapMemory memory;
    CellOverlap overlap(op, mesh, memory);
    for (std::int64_t cell = task; cell < frame_.cell_count(); cell += tasks) {
      overlap.collect(cell);
      set_cell(cell, memory, mask, voxel_ratio);
    }
  });
}

void OverlapWeights::set_cell(std::int64_t cell,
                              CellOverlapMemory& memory,
                              const std::vector<std::uint8_t>& mask,
                              double voxel_ratio) {
  if (memory.parts.size() == 0) return;
  Cell& target = cells_[static_cast<std::size_t>(cell)];
  std::array<std::vector<FacetPart>, CellOverlapMemory::voxel_count> parts;
  for (std::size_t f = 0; f + 1 < memory.facets.size(); ++f) {
    const auto add_to = [&](int voxel, double side) {
      if (voxel < 0) return;
      for (auto p = memory.facets[f].first_part; p < memory.facets[f + 1].first_part; ++p) {
        const FacetPart& part = memory.parts.data()[p];
        parts[static_cast<std::size_t>(voxel)].push_back(
            {{part.voxel[0], part.voxel[1], part.voxel[2]}, side * part.area, side * part.moment});
      }
    };
    add_to(memory.facets[f].inner, 1.0);
    add_to(memory.facets[f].outer, -1.0);
  }
  int corner[3];
  frame_.set_corner(cell, corner);
  target.begin.push_back(0);
  for (std::size_t v = 0; v < parts.size(); ++v) {
    const auto at = static_cast<int>(v);
    const int x[3] = {corner[0] + at % cell_edge, corner[1] + at / cell_edge % cell_edge,
                      corner[2] + at / (cell_edge * cell_edge)};
    bool is_used = !parts[v].empty();
    for (int axis = 0; axis < 3; ++axis) {
      is_used = is_used && x[axis] >= frame_.begin[axis] && x[axis] < frame_.end[axis];
    }
    if (is_used && !mask.empty()) {
      is_used = mask[static_cast<std::size_t>(frame_.offset_of(x[0], x[1], x[2]))] != 0;
    }
    if (is_used) {
      const double least = least_share * static_cast<double>(memory.reach[v].sum_count() / 2);
      add_shares(parts[v], least, voxel_ratio, target);
    }
    target.begin.push_back(std::ssize(target.shares));
  }
  target.shares.shrink_to_fit();
}

/// As CellOverlap::store(), with the parts in the order of the source instead of a box of sums.
/// @param parts  of the voxel's surface, whose normals point outwards
void OverlapWeights::add_shares(std::vector<FacetPart>& parts,
                                double least,
                                double voxel_ratio,
                                Cell& cell) const {
  const auto bar_of = [](const FacetPart& part) { return std::tie(part.voxel[2], part.voxel[1]); };
  std::ranges::stable_sort(parts, [&](const FacetPart& a, const FacetPart& b) {
    return bar_of(a) != bar_of(b) ? bar_of(a) < bar_of(b) : a.voxel[0] > b.voxel[0];
  });
  for (auto first = parts.begin(); first != parts.end();) {
    const auto end = std::find_if(
        first, parts.end(), [&](const FacetPart& part) { return bar_of(part) != bar_of(*first); });
    add_bar({first, end}, least, voxel_ratio, cell);
    first = end;
  }
}

/// Appends the shares in a bar of the source's voxels along i, from its end.
void OverlapWeights::add_bar(std::span<const FacetPart> parts,
                             double least,
                             double voxel_ratio,
                             Cell& cell) const {
  const std::int64_t j = parts.front().voxel[1], k = parts.front().voxel[2];
  if (j < 0 || j >= dims_[1] || k < 0 || k >= dims_[2]) return;
  double beyond = 0;  // area of the parts in voxels beyond i
  for (std::size_t p = 0; p < parts.size();) {
    std::int64_t i = parts[p].voxel[0];
    double area = 0, moment = 0;
    for (; p < parts.size() && parts[p].voxel[0] == i; ++p) {
      area += parts[p].area;
      moment += parts[p].moment;
    }
    const std::int64_t next = p < parts.size() ? parts[p].voxel[0] : i - 1;
    double volume = moment + beyond;
    beyond += area;
    for (; i > next; --i, volume = beyond) {
      if (!(volume > least) || i < 0 || i >= dims_[0]) continue;
      cell.shares.push_back({(k * dims_[1] + j) * dims_[0] + i, volume * voxel_ratio});
    }
  }
}

}  // namespace tetwarp

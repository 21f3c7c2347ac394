/// @file blocks.cpp
/// Divides the output into blocks that fit a limit of memory.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tetwarp/blocks.hpp>
#include <utility>

#include "host/base/parallel.hpp"
#include "host/warp/bad_positions.hpp"
#include "host/warp/curve_footprint.hpp"
#include "host/warp/geometry.hpp"
#include "host/warp/hex_split.hpp"
#include "host/warp/sources.hpp"
#include "host/warp/tet_footprint.hpp"
#include "kernels/warp/cell_class.hpp"
#include "kernels/warp/corner_mask.hpp"
#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {
namespace {
std::string size_text(const Region& region) {
  std::string text;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    text += (axis == 0 ? "" : " x ") + std::to_string(region.end[axis] - region.begin[axis]);
  }
  return text;
}

std::string too_large(const WarpBlock& block, const BlockLimits& limits) {
  const auto megabytes = [](double bytes) {
    return std::to_string(static_cast<std::int64_t>(std::ceil(bytes / 1e6)));
  };
  const bool on_host = block.host_bytes > limits.host;
  return "blocks: " + size_text(block.output) + " output voxels, the least at a time, read " +
         size_text(block.source) + " of the source and need " +
         megabytes(on_host ? block.host_bytes : block.device_bytes) + " MB; " +
         megabytes(std::max(on_host ? limits.host : limits.device, 0.0)) +
         " are left, allow more or choose a finer output grid";
}

std::int64_t voxels_of(const VoxelBox& box) {
  return (box.end[0] - box.begin[0]) * (box.end[1] - box.begin[1]) * (box.end[2] - box.begin[2]);
}

/// A box divided at the step nearest to its middle.
std::pair<VoxelBox, VoxelBox> halves(const VoxelBox& box, int axis, const BlockLimits& limits) {
  const std::int64_t step = limits.step[static_cast<std::size_t>(axis)];
  const std::int64_t steps = (box.end[axis] - box.begin[axis] + step - 1) / step;
  VoxelBox low = box, high = box;
  low.end[axis] = high.begin[axis] = box.begin[axis] + steps / 2 * step;
  return {low, high};
}

WarpPlan plan_of(const Grid& source, const Mesh& mesh, const WarpOptions& options) {
  check_grid(source, "source");
  check_mesh(mesh);
  WarpPlan plan;
  plan.sources = {VolumeView(source, PixelType::float32, 1, nullptr, Memory::host)};
  plan.mesh = with_split_hexes(mesh);
  plan.options = options;
  plan.output_grid = options.output_grid.value_or(source);
  plan.region = options.region.value_or(Region{{0, 0, 0}, plan.output_grid.dims});
  return plan;
}
}  // namespace

struct BlockPlanner::State {
  Mesh mesh;                        ///< as in WarpPlan
  std::vector<MidNodes> mid_nodes;  ///< as of CurvedMesh
  Grid source;
  WarpOptions options;
  WarpGeometry geometry;
  std::vector<Footprint> footprints;  ///< of every cell of the mesh, in the current step

  /// Tetrahedra that are not parts of hexahedra; they come first.
  std::int64_t lone_tet_count() const {
    return std::ssize(mesh.tets) - tets_per_hex * std::ssize(mesh.hexes);
  }
  /// Computes the footprints of a step, and the counts of its plan.
  void set_footprints(const PositionsView& deformed, BlockPlan& plan);
  /// Replaces the footprints of the parts of hexahedra by those of the hexahedra.
  void merge_hexahedra();
  /// Divides a box into blocks and appends them to a plan.
  /// @param cells  that may own voxels of the box
  void cut(const VoxelBox& box,
           std::vector<std::int32_t> cells,
           const BlockLimits& limits,
           BlockPlan& plan) const;
  WarpBlock make_block(const VoxelBox& box,
                       const std::vector<std::int32_t>& cells,
                       const BlockLimits& limits) const;
  /// The axis along which the halves of a box read the fewest source voxels; of equal ones the
  /// longest; -1: the box is one step long along all axes.
  int best_axis(const VoxelBox& box,
                const std::vector<std::int32_t>& cells,
                const BlockLimits& limits) const;
  /// The voxels of the source that the voxels of a box are computed from.
  VoxelBox source_of(const VoxelBox& box, const std::vector<std::int32_t>& cells) const;
};

BlockPlanner::BlockPlanner(const Grid& source,
                           const Mesh& mesh,
                           const WarpOptions& options,
                           const std::vector<MidNodes>& mid_nodes)
    : state_(std::make_unique<State>(State{with_split_hexes(mesh),
                                           mid_nodes,
                                           source,
                                           options,
                                           make_geometry(plan_of(source, mesh, options)),
                                           {}})) {
  check_mid_nodes(mesh, mid_nodes);
}

BlockPlanner::BlockPlanner(BlockPlanner&&) noexcept = default;
BlockPlanner::~BlockPlanner() = default;

void BlockPlanner::State::set_footprints(const PositionsView& deformed, BlockPlan& plan) {
  if (deformed.node_count != std::ssize(geometry.rest) || deformed.memory != Memory::host) {
    throw std::invalid_argument("deformed positions: expected " +
                                std::to_string(geometry.rest.size()) + " nodes in host memory");
  }
  std::vector<Node> nodes(geometry.rest.size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    nodes[n] = quantized(geometry.output_index, deformed.xyz + 3 * n, geometry.frame.origin);
  }
  const std::int64_t tet_count = std::ssize(mesh.tets);
  const View<const Node> rest{geometry.rest.data(), std::ssize(geometry.rest)};
  const std::int32_t* const ids = mesh.tets.front().data();
  TetSetupOp op{};
  op.tets = {ids, 4 * tet_count};
  op.deformed = {nodes.data(), std::ssize(nodes)};
  op.rest = rest;
  op.rest_orientation = {geometry.rest_orientation.data(), tet_count};
  op.frame = geometry.frame;
  if (!mesh.hexes.empty()) {
    op.hexes = {{mesh.hexes.front().data(), 8 * std::ssize(mesh.hexes)}, lone_tet_count()};
  }
  // An average takes samples up to half an output voxel away on either side.
  const double spread = options.antialias ? 0.5 : 0;
  footprints.resize(mesh.tets.size());
  std::atomic<std::int64_t> inverted = 0, flat = 0, bad = tet_count;
  parallel_for(thread_count(options.threads), tet_count, [&](std::int64_t t) {
    TetSetup setup = {};
    const TetClass tet_class = op.set_up(t, setup);
    inverted += tet_class == TetClass::inverted;
    flat += tet_class == TetClass::flat;
    if (tet_class == TetClass::bad_position || tet_class == TetClass::too_large) {
      for (std::int64_t first = bad; t < first && !bad.compare_exchange_weak(first, t);) {
      }
    }
    const bool owns = tet_class == TetClass::regular || tet_class == TetClass::inverted;
    if (!owns) setup = {};
    const auto tet = static_cast<std::size_t>(t);
    footprints[tet] = footprint_of(setup, tet_nodes(rest, ids + 4 * t), spread);
    if (owns && tet < mid_nodes.size() && mid_nodes[tet] != no_mid_nodes) {
      extend_by_curve(setup, op.deformed, rest, ids + 4 * t, mid_nodes[tet].data(),
                      footprints[tet]);
    }
  });
  if (bad < tet_count) {
    TetSetup setup = {};
    throw_on_bad_position(op.set_up(bad, setup), bad);
  }
  plan.tetrahedra = tet_count;
  plan.inverted = inverted;
  plan.flat = flat;
  merge_hexahedra();
}

void BlockPlanner::State::merge_hexahedra() {
  const View<const Node> rest{geometry.rest.data(), std::ssize(geometry.rest)};
  const std::int64_t lone = lone_tet_count(), hex_count = std::ssize(mesh.hexes);
  constexpr std::int64_t from[3] = {0, 0, 0};
  for (std::int64_t h = 0; h < hex_count; ++h) {
    const HexCorners corners =
        hex_corners(rest, mesh.hexes[static_cast<std::size_t>(h)].data(), from);
    footprints[static_cast<std::size_t>(lone + h)] =
        footprint_of(&footprints[static_cast<std::size_t>(lone + tets_per_hex * h)], corners);
  }
  footprints.resize(static_cast<std::size_t>(lone + hex_count));
}

VoxelBox BlockPlanner::State::source_of(const VoxelBox& box,
                                        const std::vector<std::int32_t>& cells) const {
  VoxelBox all;
  for (int axis = 0; axis < 3; ++axis) {
    all.begin[axis] = source.dims[static_cast<std::size_t>(axis)];
    all.end[axis] = 0;
  }
  if (options.outside == Outside::identity) {
    const OutsideMap& map = geometry.outside;
    VoxelBox in_grid = box;
    for (int axis = 0; axis < 3; ++axis) {
      in_grid.begin[axis] += geometry.frame.origin[axis];
      in_grid.end[axis] += geometry.frame.origin[axis];
    }
    const int spread = options.antialias ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis) {
      in_grid.begin[axis] -= spread;
      in_grid.end[axis] += spread;
    }
    enclose(all, image_of(in_grid, map.linear, map.offset));
  }
  for (const std::int32_t t : cells) {
    const Footprint& footprint = footprints[static_cast<std::size_t>(t)];
    if (meets(footprint, box)) enclose(all, samples_of(footprint, box));
  }
  const int reach = reach_of(options.filter);
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t count = source.dims[static_cast<std::size_t>(axis)];
    all.begin[axis] = std::clamp<std::int64_t>(all.begin[axis] - reach, 0, count - 1);
    all.end[axis] = std::clamp<std::int64_t>(all.end[axis] + reach, all.begin[axis] + 1, count);
  }
  return all;
}

WarpBlock BlockPlanner::State::make_block(const VoxelBox& box,
                                          const std::vector<std::int32_t>& cells,
                                          const BlockLimits& limits) const {
  WarpBlock block;
  const VoxelBox from = source_of(box, cells);
  double output_voxels = 1, source_voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.output.begin[axis] = box.begin[axis] + geometry.frame.origin[axis];
    block.output.end[axis] = box.end[axis] + geometry.frame.origin[axis];
    block.source.begin[axis] = from.begin[axis];
    block.source.end[axis] = from.end[axis];
    output_voxels *= static_cast<double>(box.end[axis] - box.begin[axis]);
    source_voxels *= static_cast<double>(from.end[axis] - from.begin[axis]);
  }
  // Per tetrahedron: setup, nodes, mesh. Per pair: the list and its copy for sorting. Per output
  // voxel: ranges, counts and work of cells, which have 512 voxels. Per source voxel: two bytes for
  // each block that may be constant. Per curved tetrahedron: six nodes that no other one has, with
  // five positions and a number each.
  constexpr double straight_bytes = 600, curve_bytes = 6 * (5 * 24 + 4);
  constexpr double pair_bytes = 32, output_share = 0.1, source_share = 0.005;
  const double tet_bytes = straight_bytes + (mid_nodes.empty() ? 0 : curve_bytes);
  const auto hexes = cells.end() - std::ranges::lower_bound(cells, lone_tet_count());
  const auto tets = std::ssize(cells) + (tets_per_hex - 1) * hexes;
  const double around = tet_bytes * static_cast<double>(tets) +
                        (output_share + limits.scratch_voxel) * output_voxels +
                        source_share * source_voxels;
  const double mask_bytes =
      options.expert.skip.grid_point_masks ? most_corners(1) * sizeof(std::uint16_t) : 0.0;
  double pairs = 0;
  for (const std::int32_t t : cells) {
    pairs += static_cast<double>(pairs_of(footprints[static_cast<std::size_t>(t)], box));
  }
  const double samples = limits.source_voxel * source_voxels + limits.output_voxel * output_voxels;
  block.host_bytes = 2 * samples + around + (pair_bytes + mask_bytes) * pairs;

  // A device keeps two lists of pairs and three arrays for sorting, with room for a quarter more
  // pairs; and a list of cells.
  constexpr double device_pair_bytes = 36, list_room = 1.25, least_room = 1024;
  const double cell_count = output_voxels / (cell_edge * cell_edge * cell_edge);
  const double room = list_room * pairs + least_room;
  block.device_bytes = samples + around + (device_pair_bytes + mask_bytes) * room +
                       (options.expert.skip.interior_cells ? class_list_bytes(cell_count) : 0.0);
  return block;
}

int BlockPlanner::State::best_axis(const VoxelBox& box,
                                   const std::vector<std::int32_t>& cells,
                                   const BlockLimits& limits) const {
  int best = -1;
  std::int64_t least = 0, longest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t length = box.end[axis] - box.begin[axis];
    if (length <= limits.step[static_cast<std::size_t>(axis)]) continue;
    const auto [low, high] = halves(box, axis, limits);
    const std::int64_t reads = voxels_of(source_of(low, cells)) + voxels_of(source_of(high, cells));
    if (best >= 0 && (reads > least || (reads == least && length <= longest))) continue;
    best = axis;
    least = reads;
    longest = length;
  }
  return best;
}

void BlockPlanner::State::cut(const VoxelBox& box,
                              std::vector<std::int32_t> cells,
                              const BlockLimits& limits,
                              BlockPlan& plan) const {
  std::erase_if(
      cells, [&](std::int32_t t) { return !meets(footprints[static_cast<std::size_t>(t)], box); });
  WarpBlock block = make_block(box, cells, limits);
  const bool fits = block.host_bytes <= limits.host && block.device_bytes <= limits.device;
  const bool is_small = block.output.voxel_count() <= limits.max_voxels;
  const int axis = fits && is_small ? -1 : best_axis(box, cells, limits);
  if (axis < 0) {
    if (!fits) throw std::invalid_argument(too_large(block, limits));
    block.cells = std::move(cells);
    plan.blocks.push_back(std::move(block));
    return;
  }
  const auto [low, high] = halves(box, axis, limits);
  cut(low, cells, limits, plan);
  cut(high, std::move(cells), limits, plan);
}

BlockPlan BlockPlanner::plan(const PositionsView& deformed, const BlockLimits& limits) {
  BlockPlan plan;
  state_->set_footprints(deformed, plan);
  VoxelBox all;
  for (int axis = 0; axis < 3; ++axis) {
    all.begin[axis] = state_->geometry.frame.begin[axis];
    all.end[axis] = state_->geometry.frame.end[axis];
  }
  std::vector<std::int32_t> cells(state_->footprints.size());
  std::iota(cells.begin(), cells.end(), 0);
  state_->cut(all, std::move(cells), limits, plan);
  return plan;
}

}  // namespace tetwarp

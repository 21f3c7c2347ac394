/// @file blocks.cpp
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tetwarp/blocks.hpp>
#include <utility>

#include "host/bad_positions.hpp"
#include "host/tet_footprint.hpp"
#include "host/warp_geometry.hpp"
#include "host/warp_sources.hpp"
#include "kernels/tet_setup.hpp"

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

WarpPlan plan_of(const Grid& source, const TetMesh& mesh, const WarpOptions& options) {
  check_grid(source, "source");
  check_mesh(mesh);
  WarpPlan plan;
  plan.sources = {VolumeView(source, PixelType::float32, 1, nullptr, Memory::host)};
  plan.mesh = mesh;
  plan.options = options;
  plan.output_grid = options.output_grid.value_or(source);
  plan.region = options.region.value_or(Region{{0, 0, 0}, plan.output_grid.dims});
  return plan;
}

}  // namespace

struct BlockPlanner::State {
  const TetMesh& mesh;
  Grid source;
  WarpOptions options;
  WarpGeometry geometry;
  std::vector<Footprint> footprints;  ///< of the step at hand

  void set_footprints(const PositionsView& deformed, BlockPlan& plan);
  /// Appends the blocks of a box to a plan.
  void cut(const Box& box,
           std::vector<std::int32_t> tets,
           const BlockLimits& limits,
           BlockPlan& plan) const;
  WarpBlock make_block(const Box& box,
                       const std::vector<std::int32_t>& tets,
                       const BlockLimits& limits) const;
  /// What is read for the voxels of a box.
  Box source_of(const Box& box, const std::vector<std::int32_t>& tets) const;
};

BlockPlanner::BlockPlanner(const Grid& source, const TetMesh& mesh, const WarpOptions& options)
    : state_(std::make_unique<State>(
          State{mesh, source, options, make_geometry(plan_of(source, mesh, options)), {}})) {}

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
  TetSetupBody body{};
  body.tets = {ids, 4 * tet_count};
  body.deformed = {nodes.data(), std::ssize(nodes)};
  body.rest = rest;
  body.rest_orientation = {geometry.rest_orientation.data(), tet_count};
  body.frame = geometry.frame;
  footprints.resize(mesh.tets.size());
  std::int64_t inverted = 0, flat = 0, bad = tet_count;
#pragma omp parallel for reduction(+ : inverted, flat) reduction(min : bad)
  for (std::int64_t t = 0; t < tet_count; ++t) {
    TetSetup setup = {};
    const TetClass tet_class = body.set_up(t, setup);
    inverted += tet_class == TetClass::inverted;
    flat += tet_class == TetClass::flat;
    if (tet_class == TetClass::bad_position || tet_class == TetClass::too_large) {
      bad = std::min(bad, t);
    }
    if (tet_class != TetClass::regular && tet_class != TetClass::inverted) setup = {};
    footprints[static_cast<std::size_t>(t)] = footprint_of(setup, tet_nodes(rest, ids + 4 * t));
  }
  if (bad < tet_count) {
    TetSetup setup = {};
    throw_on_bad_position(body.set_up(bad, setup), bad);
  }
  plan.inverted = inverted;
  plan.flat = flat;
}

Box BlockPlanner::State::source_of(const Box& box, const std::vector<std::int32_t>& tets) const {
  Box all;
  for (int axis = 0; axis < 3; ++axis) {
    all.begin[axis] = source.dims[static_cast<std::size_t>(axis)];
    all.end[axis] = 0;
  }
  if (options.outside == Outside::identity) {
    const OutsideMap& map = geometry.outside;
    Box in_grid = box;
    for (int axis = 0; axis < 3; ++axis) {
      in_grid.begin[axis] += geometry.frame.origin[axis];
      in_grid.end[axis] += geometry.frame.origin[axis];
    }
    enclose(all, image_of(in_grid, map.linear, map.offset));
  }
  for (const std::int32_t t : tets) {
    const Footprint& footprint = footprints[static_cast<std::size_t>(t)];
    enclose(all, samples_of(footprint, box));
  }
  const int reach = reach_of(interpolation_of(options.filter));
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t count = source.dims[static_cast<std::size_t>(axis)];
    all.begin[axis] = std::clamp<std::int64_t>(all.begin[axis] - reach, 0, count - 1);
    all.end[axis] = std::clamp<std::int64_t>(all.end[axis] + reach, all.begin[axis] + 1, count);
  }
  return all;
}

WarpBlock BlockPlanner::State::make_block(const Box& box,
                                          const std::vector<std::int32_t>& tets,
                                          const BlockLimits& limits) const {
  WarpBlock block;
  const Box from = source_of(box, tets);
  double output_voxels = 1, source_voxels = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.output.begin[axis] = box.begin[axis] + geometry.frame.origin[axis];
    block.output.end[axis] = box.end[axis] + geometry.frame.origin[axis];
    block.source.begin[axis] = from.begin[axis];
    block.source.end[axis] = from.end[axis];
    output_voxels *= static_cast<double>(box.end[axis] - box.begin[axis]);
    source_voxels *= static_cast<double>(from.end[axis] - from.begin[axis]);
  }
  // Setups, nodes and the mesh itself; lists of pairs and a copy to sort them; ranges, counts and
  // work of cells of 512 voxels; two bytes per block of the source that may be constant.
  constexpr double tet_bytes = 600, pair_bytes = 32, output_share = 0.1, source_share = 0.005;
  double around = tet_bytes * static_cast<double>(tets.size()) +
                  (output_share + limits.scratch_voxel) * output_voxels +
                  source_share * source_voxels;
  for (const std::int32_t t : tets) {
    around +=
        pair_bytes * static_cast<double>(pairs_of(footprints[static_cast<std::size_t>(t)], box));
  }
  const double samples = limits.source_voxel * source_voxels + limits.output_voxel * output_voxels;
  block.host_bytes = 2 * samples + around;
  block.device_bytes = samples + around;
  return block;
}

void BlockPlanner::State::cut(const Box& box,
                              std::vector<std::int32_t> tets,
                              const BlockLimits& limits,
                              BlockPlan& plan) const {
  std::erase_if(
      tets, [&](std::int32_t t) { return !meets(footprints[static_cast<std::size_t>(t)], box); });
  WarpBlock block = make_block(box, tets, limits);
  if (block.host_bytes <= limits.host && block.device_bytes <= limits.device &&
      block.output.voxel_count() <= limits.most_voxels) {
    block.tets = std::move(tets);
    plan.blocks.push_back(std::move(block));
    return;
  }
  int longest = -1;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t length = box.end[axis] - box.begin[axis];
    if (length <= limits.step[static_cast<std::size_t>(axis)]) continue;
    if (longest < 0 || length > box.end[longest] - box.begin[longest]) longest = axis;
  }
  if (longest < 0) throw std::invalid_argument(too_large(block, limits));
  const std::int64_t step = limits.step[static_cast<std::size_t>(longest)];
  const std::int64_t steps = (box.end[longest] - box.begin[longest] + step - 1) / step;
  Box low = box, high = box;
  low.end[longest] = high.begin[longest] = box.begin[longest] + steps / 2 * step;
  cut(low, tets, limits, plan);
  cut(high, std::move(tets), limits, plan);
}

BlockPlan BlockPlanner::plan(const PositionsView& deformed, const BlockLimits& limits) {
  BlockPlan plan;
  state_->set_footprints(deformed, plan);
  Box all;
  for (int axis = 0; axis < 3; ++axis) {
    all.begin[axis] = state_->geometry.frame.begin[axis];
    all.end[axis] = state_->geometry.frame.end[axis];
  }
  std::vector<std::int32_t> tets(state_->footprints.size());
  std::iota(tets.begin(), tets.end(), 0);
  state_->cut(all, std::move(tets), limits, plan);
  return plan;
}

std::vector<Point3> BlockMesh::of(const std::vector<Point3>& positions) const {
  std::vector<Point3> part;
  part.reserve(nodes.size());
  for (const std::int32_t n : nodes) part.push_back(positions[static_cast<std::size_t>(n)]);
  return part;
}

BlockMesh block_mesh(const TetMesh& mesh, const WarpBlock& block) {
  constexpr std::int32_t none = -1;
  std::vector<std::int32_t> place(mesh.rest_positions.size(), none);
  BlockMesh part;
  const auto add = [&](const std::array<std::int32_t, 4>& tet) {
    std::array<std::int32_t, 4>& own = part.mesh.tets.emplace_back(tet);
    for (std::int32_t& node : own) {
      std::int32_t& at = place[static_cast<std::size_t>(node)];
      if (at == none) {
        at = static_cast<std::int32_t>(part.nodes.size());
        part.nodes.push_back(node);
      }
      node = at;
    }
  };
  for (const std::int32_t t : block.tets) add(mesh.tets[static_cast<std::size_t>(t)]);
  if (block.tets.empty()) add(mesh.tets.front());
  part.mesh.rest_positions = part.of(mesh.rest_positions);
  return part;
}

}  // namespace tetwarp

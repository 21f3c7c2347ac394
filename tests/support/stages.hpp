/// @file stages.hpp
/// The stages of the warp run one after another on an executor, their results kept for inspection.
#pragma once
#include <array>
#include <cstdint>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "host/warp/geometry.hpp"
#include "kernels/warp/cell_pairs.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/corner_mask.hpp"
#include "kernels/warp/node_quantize.hpp"
#include "kernels/warp/tet_setup.hpp"
#include "tests/support/each_exec.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {

/// A mesh in the terms of the kernels.
struct StageInput {
  std::vector<std::int32_t> tets;  ///< four nodes each
  std::vector<Node> deformed;
  std::vector<Node> rest;
  std::vector<std::int8_t> rest_orientation;
  OutputFrame frame;
};

/// A frame of whole cells from voxel zero on.
inline OutputFrame frame_of(int nx, int ny, int nz) {
  const int edge = cell_edge - 1;
  return {{0, 0, 0},
          {0, 0, 0},
          {nx, ny, nz},
          {(nx + edge) / cell_edge, (ny + edge) / cell_edge, (nz + edge) / cell_edge}};
}

/// A node at a position in voxels.
inline Node node_at(double x, double y, double z) {
  const double q = static_cast<double>(quanta_per_voxel);
  return {{std::lrint(x * q), std::lrint(y * q), std::lrint(z * q)}};
}

/// One tetrahedron, deformed and at rest.
inline StageInput one_tet(const std::vector<Node>& deformed,
                          const std::vector<Node>& rest,
                          const OutputFrame& frame) {
  const View<const Node> nodes{rest.data(), 4};
  const std::int32_t tet[4] = {0, 1, 2, 3};
  const int sign = orientation(tet_nodes(nodes, tet));
  return {{0, 1, 2, 3}, deformed, rest, {static_cast<std::int8_t>(sign)}, frame};
}

/// A scene, cut to a region of its output grid.
inline StageInput input_of(const scenes::Scene& scene, std::optional<Region> region = {}) {
  WarpPlan plan;
  plan.sources = {{scene.source_grid, PixelType::float32, 1, nullptr, Memory::host}};
  plan.mesh = scene.mesh;
  plan.output_grid = scene.output_grid;
  plan.region = region.value_or(Region{{0, 0, 0}, scene.output_grid.dims});
  const WarpGeometry geometry = make_geometry(plan);
  StageInput input{{}, {}, geometry.rest, geometry.rest_orientation, geometry.frame};
  for (const auto& tet : scene.mesh.tets) {
    input.tets.insert(input.tets.end(), tet.begin(), tet.end());
  }
  for (const Point3& p : scene.deformed) {
    input.deformed.push_back(quantized(geometry.output_index, p.data(), geometry.frame.origin));
  }
  return input;
}

/// A rotated scene of `count` tetrahedra, many of them the same.
inline scenes::Scene scene_of_tets(std::int64_t count) {
  scenes::Scene scene = scenes::adversarial_scene("rotated", 24);
  const std::vector<std::array<std::int32_t, 4>> tets = std::exchange(scene.mesh.tets, {});
  for (std::size_t t = 0; t < static_cast<std::size_t>(count); ++t) {
    scene.mesh.tets.push_back(tets[t * 7 % tets.size()]);
  }
  return scene;
}

/// Every stage up to the sorted pairs.
template <class Exec>
class Stages {
 public:
  View<std::int32_t> tets;
  View<Node> nodes;
  View<TetSetup> setups;
  View<std::int64_t> corner_offsets;
  View<std::int64_t> pair_offsets;
  View<std::int64_t> classes;
  View<std::uint16_t> masks;
  View<CellPair> candidates;         ///< culled by planes
  View<CellPair> masked_candidates;  ///< culled by masks
  View<CellPair> pairs;
  View<std::int64_t> pair_count;
  View<CellRange> ranges;
  View<std::int64_t> accepted;

  Stages(ExecArrays<Exec>& arrays, const StageInput& input, CullSwitches switches = {})
      : tets(arrays.upload(input.tets)), nodes(arrays.upload(input.deformed)) {
    Exec& exec = arrays.exec();
    const auto count = static_cast<std::int64_t>(input.tets.size() / 4);
    setups = arrays.template zeros<TetSetup>(count);
    corner_offsets = arrays.template zeros<std::int64_t>(count + 1);
    pair_offsets = arrays.template zeros<std::int64_t>(count + 1);
    classes = arrays.template zeros<std::int64_t>(tet_class_count);
    tet_setup(exec, {tets, nodes, arrays.upload(input.rest), arrays.upload(input.rest_orientation),
                     input.frame, setups, pair_offsets, classes});
    exec.exclusive_scan("test/setup", pair_offsets);
    make_masks(arrays);
    candidates = arrays.template zeros<CellPair>(arrays.download(pair_offsets).back());
    cell_cull(exec, setups, PlaneVerdict{}, pair_offsets, switches, input.frame, candidates);
    masked_candidates = arrays.template zeros<CellPair>(candidates.size);
    cell_cull(exec, setups, mask_verdict(masks), pair_offsets, switches, input.frame,
              masked_candidates);
    sort(arrays, input.frame);
  }

  MaskVerdict<View<const std::int64_t>> mask_verdict(View<const std::uint16_t> of) const {
    return {corner_offsets, of};
  }

  /// A raster of whole sources in the tests' memory; outputs are to be set.
  template <class T>
  RasterJob<T> raster_job(const StageInput& input, const Volume& source) const {
    RasterJob<T> job{};
    job.setups = setups;
    job.tets = tets;
    job.nodes = nodes;
    job.pairs = pairs;
    job.ranges = ranges;
    job.frame = input.frame;
    job.source =
        source_view<T>(Region{{0, 0, 0}, source.grid.dims}, source.components, source.data.data());
    job.background = T{77};
    return job;
  }

 private:
  void make_masks(ExecArrays<Exec>& arrays) {
    Exec& exec = arrays.exec();
    const View<const std::int64_t> offsets = corner_offsets;
    exec.for_each("test/mask", setups.size,
                  CornerCountOp<View<const std::int64_t>>{setups, pair_offsets, corner_offsets});
    exec.exclusive_scan("test/mask", corner_offsets);
    masks = arrays.template zeros<std::uint16_t>(arrays.download(corner_offsets).back());
    corner_mask(exec, setups, offsets, masks);
  }

  /// Makes the list of pairs on the host: a device makes it by other stages.
  void sort(ExecArrays<Exec>& arrays, const OutputFrame& frame) {
    CpuExec host(1);
    std::vector<CellPair> from = arrays.download(candidates), to(from.size());
    std::vector<CellRange> cells(static_cast<std::size_t>(frame.cell_count()));
    const auto size = static_cast<std::int64_t>(from.size());
    std::int64_t kept = 0, accepted_pairs = 0;
    cell_pairs(host, View<const CellPair>{from.data(), size}, {&size, 1}, frame, {to.data(), size},
               {&kept, 1}, {cells.data(), frame.cell_count()}, {&accepted_pairs, 1});
    pairs = arrays.upload(to);
    ranges = arrays.upload(cells);
    pair_count = arrays.upload(std::vector{kept});
    accepted = arrays.upload(std::vector{accepted_pairs});
  }
};

}  // namespace tetwarp::test

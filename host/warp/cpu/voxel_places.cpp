/// @file voxel_places.cpp
/// Takes owners from a warp, and maps from the stages of the warp.
#include "host/warp/cpu/voxel_places.hpp"

#include <tetwarp/warp.hpp>

#include "host/base/parallel.hpp"
#include "host/warp/hex_split.hpp"

namespace tetwarp {
VoxelPlaces::VoxelPlaces(const WarpPlan& plan,
                         const std::vector<Point3>& deformed,
                         const std::vector<std::uint8_t>& mask,
                         int threads)
    : source_(plan.sources.front().grid),
      output_(plan.output_grid),
      mesh_(plan.mesh),
      geometry_(make_geometry(plan)) {
  if (!mesh_.hexes.empty()) {
    hexes_ = {{mesh_.hexes.front().data(), 8 * std::ssize(mesh_.hexes)},
              tet_count() - tets_per_hex * std::ssize(mesh_.hexes)};
  }
  find_owners(deformed, threads);
  set_up(deformed, threads);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    if (mask[v] == 0) owners_[v] = left_out;
  }
}

/// By a warp of one voxel, whose samples nobody needs, with the parts of hexahedra as tetrahedra.
void VoxelPlaces::find_owners(const std::vector<Point3>& deformed, int threads) {
  Grid one = source_;
  one.dims = {1, 1, 1};
  const std::uint8_t sample = 0;
  const VolumeView source(one, PixelType::uint8, 1, &sample, Memory::host);
  const Mesh tets{mesh_.rest_positions, mesh_.tets, {}};
  WarpOptions options{.filter = Filter::nearest, .output_grid = output_};
  options.backend = Backend::cpu;
  options.threads = threads;
  const auto voxels = static_cast<std::size_t>(output_.voxel_count());
  std::vector<std::uint8_t> samples(voxels);
  owners_.resize(voxels);
  void* const data = samples.data();
  Warper warper(std::span(&source, 1), tets, options);
  warper.step(deformed, {.volumes = std::span(&data, 1), .owner = owners_.data()});
}

void VoxelPlaces::set_up(const std::vector<Point3>& deformed, int threads) {
  for (const Point3& x : deformed) {
    nodes_.push_back(quantized(geometry_.output_index, x.data(), geometry_.frame.origin));
  }
  TetSetupOp body{};
  body.tets = {mesh_.tets.front().data(), 4 * tet_count()};
  body.deformed = {nodes_.data(), node_count()};
  body.rest = {geometry_.rest.data(), node_count()};
  body.rest_orientation = {geometry_.rest_orientation.data(), tet_count()};
  body.frame = geometry_.frame;
  body.hexes = hexes_;
  setups_.resize(mesh_.tets.size());
  parallel_for(threads, tet_count(), [&](std::int64_t t) {
    TetSetup& setup = setups_[static_cast<std::size_t>(t)];
    if (body.set_up(t, setup) == TetClass::flat) setup = {};  // owns nothing
  });
}

const HexMap& VoxelPlaces::hex_map(std::int64_t t, HexCache& cache) const {
  if (cache.tet != t) {
    const HexMesh mesh{hexes_,
                       {mesh_.tets.front().data(), 4 * tet_count()},
                       {nodes_.data(), node_count()},
                       {geometry_.rest.data(), node_count()}};
    cache.map = make_hex_map(mesh, t, setups_[static_cast<std::size_t>(t)]);
    cache.tet = t;
  }
  return *cache.map;
}

void VoxelPlaces::split(const double* position, SourcePlace& place) {
  for (int axis = 0; axis < 3; ++axis) {
    const double whole = whole_voxel(position[axis]);
    place.whole[axis] = static_cast<int>(whole);
    place.at[axis] = position[axis] - whole;
  }
}

void VoxelPlaces::set_place(std::int64_t t,
                            const int* x,
                            HexCache& cache,
                            SourcePlace& place) const {
  const TetSetup& tet = setups_[static_cast<std::size_t>(t)];
  if (tet.kind == MapKind::trilinear) {
    return hex_source_position(hex_map(t, cache), x, place.whole, place.at);
  }
  double start[3], linear[3][3];
  map_start(tet, x, start, linear);
  split(start, place);
}

bool VoxelPlaces::set_dependence(std::int64_t t,
                                 const int* x,
                                 HexCache& cache,
                                 Dependence& result) const {
  const TetSetup& tet = setups_[static_cast<std::size_t>(t)];
  if (hexes_.has(t)) {
    double u[3];
    const HexMap& map = hex_map(t, cache);
    hex_local(map, x, u);
    result.count = 8;
    for (int a = 0; a < 8; ++a) {
      result.weight[a] = 1;
      for (int axis = 0; axis < 3; ++axis) {
        result.weight[a] *= unit_corner(a, axis) != 0 ? u[axis] : 1 - u[axis];
      }
    }
    return hex_gradient(map, u, result.backward);
  }
  result.count = 4;
  for (int face = 0; face < 4; ++face) {
    double value = tet.plane[3][face];
    for (int axis = 0; axis < 3; ++axis) {
      value += tet.plane[axis][face] * static_cast<double>(x[axis] - tet.anchor[axis]);
    }
    result.weight[face] = value / tet.height[face];
  }
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) result.backward.at[row][axis] = tet.map[axis][row];
  }
  return true;
}

}  // namespace tetwarp

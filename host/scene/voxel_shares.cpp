/// @file voxel_shares.cpp
/// Clips the boxes of the voxels around each tetrahedron.
#include "host/scene/voxel_shares.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/index_space.hpp"

namespace tetwarp {
namespace {

/// Smaller shares are rounding, in terms of the tetrahedron's volume or the voxel's.
constexpr double smallest_share = 1e-10;

/// Slopes and values of the four N_a, and the voxels of the region whose boxes may meet the
/// tetrahedron.
TetSetup setup_of(const std::array<Point3, 4>& corners, const Region& region) {
  TetSetup setup{};
  Point3 anchor;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] =
        std::minmax({corners[0][d], corners[1][d], corners[2][d], corners[3][d]});
    anchor[d] = std::floor(low);
    setup.anchor[d] = static_cast<std::int64_t>(anchor[d]);
    const auto clamped = [&](double index) {
      return static_cast<int>(std::clamp(index, static_cast<double>(region.begin[d]),
                                         static_cast<double>(region.end[d])));
    };
    setup.begin[d] = clamped(std::floor(low + 0.5));
    setup.end[d] = clamped(std::floor(high + 0.5) + 1);
  }
  const std::array<Point3, 3> edge{minus(corners[1], corners[0]), minus(corners[2], corners[0]),
                                   minus(corners[3], corners[0])};
  const double six_volumes = dot(edge[0], cross(edge[1], edge[2]));
  const Point3 from_corner = minus(anchor, corners[0]);
  setup.plane[3][0] = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const Point3 slope = times(1 / six_volumes, cross(edge[(a + 1) % 3], edge[(a + 2) % 3]));
    for (std::size_t d = 0; d < 3; ++d) {
      setup.plane[d][a + 1] = slope[d];
      setup.plane[d][0] -= slope[d];
    }
    setup.plane[3][a + 1] = dot(slope, from_corner);
    setup.plane[3][0] -= setup.plane[3][a + 1];
  }
  return setup;
}

}  // namespace

std::vector<Point3> index_positions(const Grid& grid, const std::vector<Point3>& points_world) {
  const IndexFromWorld map = index_from_world(grid);
  std::vector<Point3> points;
  points.reserve(points_world.size());
  for (const Point3& x : points_world) {
    Point3& index = points.emplace_back(Point3{0, 0, 0});
    for (std::size_t d = 0; d < 3; ++d) {
      for (std::size_t e = 0; e < 3; ++e) index[d] += map.linear[d][e] * (x[e] - map.origin[e]);
    }
  }
  return points;
}

void for_shares(const std::array<Point3, 4>& corners,
                const Region& region,
                const std::function<bool(const VoxelIndex&)>& wants,
                const std::function<bool(const VoxelIndex&, const VoxelShare&)>& visit) {
  const TetSetup setup = setup_of(corners, region);
  const double volume = std::abs(tet_volume(corners[0], corners[1], corners[2], corners[3]));
  const double least = smallest_share * std::min(volume, 1.0);
  for (int k = setup.begin[2]; k < setup.end[2]; ++k) {
    for (int j = setup.begin[1]; j < setup.end[1]; ++j) {
      for (int i = setup.begin[0]; i < setup.end[0]; ++i) {
        const VoxelIndex voxel{i, j, k};
        if (!wants(voxel)) continue;
        const int x[3] = {i, j, k};
        const VoxelShare share = share_of(setup, x);
        if (share.volume > least && !visit(voxel, share)) return;
      }
    }
  }
}

bool has_share(const std::array<Point3, 4>& corners,
               const Region& region,
               const std::function<bool(const VoxelIndex&)>& wants) {
  bool is_found = false;
  for_shares(corners, region, wants, [&](const VoxelIndex&, const VoxelShare&) {
    is_found = true;
    return false;
  });
  return is_found;
}

}  // namespace tetwarp

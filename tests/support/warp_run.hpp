/// @file warp_run.hpp
/// One call that warps and keeps all outputs.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/warp.hpp>

#include "host/base/pixel_dispatch.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {

/// Outputs and counts of one step.
struct Warped {
  Volume volume;
  std::vector<std::uint8_t> mask;
  std::vector<std::int32_t> owner;
  Counts counts;
};

/// One step of a Warper with all its outputs.
inline Warped run_step(Warper& warper,
                       const Volume& source,
                       const std::vector<Point3>& deformed,
                       const Progress& progress = {}) {
  Warped warped;
  warped.volume = make_volume(warper.output_grid(), source.type, source.components);
  const auto voxels = static_cast<std::size_t>(warper.output_grid().voxel_count());
  warped.mask.assign(voxels, 0xee);
  warped.owner.assign(voxels, -99);
  void* const data = warped.volume.data.data();
  const WarpTarget target = {
      .volumes = std::span(&data, 1), .mask = warped.mask.data(), .owner = warped.owner.data()};
  warped.counts = warper.step(deformed, target, progress).counts;
  return warped;
}

/// A scene warped from its source grid to its output grid.
inline Warped run_warp(const Volume& source,
                       const scenes::Scene& scene,
                       Backend backend,
                       WarpOptions options = {}) {
  options.backend = backend;
  options.output_grid = scene.output_grid;
  Warper warper(source, scene.mesh, options);
  return run_step(warper, source, scene.deformed);
}

/// The samples as numbers.
inline std::vector<double> numbers_of(const Volume& volume) {
  std::vector<double> numbers;
  with_pixel_type(volume.type, [&]<class T>(T) {
    for (const T sample : volume.samples<T>()) numbers.push_back(static_cast<double>(sample));
  });
  return numbers;
}

/// Largest difference of samples; infinite between volumes of different sizes.
inline double largest_difference(const Volume& a, const Volume& b) {
  const auto x = numbers_of(a), y = numbers_of(b);
  double largest = x.size() == y.size() ? 0 : INFINITY;
  for (std::size_t s = 0; s < x.size(); ++s) largest = std::max(largest, std::abs(x[s] - y[s]));
  return largest;
}

/// Whether samples, mask and owners have the same bits.
inline bool is_same(const Warped& a, const Warped& b) {
  return a.volume.data == b.volume.data && a.mask == b.mask && a.owner == b.owner;
}

/// A mesh that covers every voxel of the grid, hull included: half a voxel beyond the outer ones.
inline Mesh covering_mesh(const Grid& grid) {
  Point3 high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    high[axis] = static_cast<double>(grid.dims[axis]) - 0.5;
  }
  Mesh mesh = scenes::lattice({3, 4, 3}, {-0.5, -0.5, -0.5}, high);
  for (Point3& p : mesh.rest_positions) p = grid.world_of(p);
  return mesh;
}

/// Positions moved by whole numbers of a grid's voxels.
inline std::vector<Point3> moved(const Grid& grid,
                                 const std::vector<Point3>& positions,
                                 const Point3& voxels) {
  const Point3 to = grid.world_of(voxels);
  return scenes::shifted(positions,
                         {to[0] - grid.origin[0], to[1] - grid.origin[1], to[2] - grid.origin[2]});
}

}  // namespace tetwarp::test

/// @file solid_scenes.hpp
/// Boxes filled with tetrahedra whose deformed hull is known exactly, so that voxels
/// missed inside and covered outside can be counted without any back end.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "tests/support/warp_run.hpp"

namespace tetwarp::test {

/// A scene whose deformed mesh fills the image of a box.
struct Solid {
  scenes::Scene scene;
  Point3 low, high;                             ///< of the box [world]
  std::function<Point3(const Point3&)> undone;  ///< takes the image back to the box [world]
};

/// A lattice over a box, its inner nodes moved at random by at most `share` of a cell per axis; a
/// tenth leaves every tetrahedron its orientation.
inline Mesh jittered_lattice(const std::array<int, 3>& cells,
                             const Point3& low,
                             const Point3& high,
                             double share,
                             std::uint64_t seed) {
  Mesh mesh = scenes::lattice(cells, low, high);
  std::uint64_t draw = 0;
  for (Point3& p : mesh.rest_positions) {
    Point3 cell;
    bool is_inner = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = (high[axis] - low[axis]) / cells[axis];
      const double layer = std::round((p[axis] - low[axis]) / cell[axis]);
      is_inner = is_inner && layer > 0 && layer < cells[axis];
    }
    if (!is_inner) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      p[axis] += share * cell[axis] * (2 * scenes::uniform(seed, draw++) - 1);
    }
  }
  return mesh;
}

/// Undoes rotated_45_45().
inline Point3 turned_back(const Point3& p, const Point3& center) {
  const double h = std::sqrt(0.5);
  const double x = p[0] - center[0], y = p[1] - center[1], z = p[2] - center[2];
  const double turned = h * (y + z);
  return {center[0] + h * (x + turned), center[1] + h * (turned - x), center[2] + h * (z - y)};
}

/// A box jittered in two ways, one of them turned by 45 degrees about two axes: well-shaped
/// tetrahedra, each with another map. `grid` is the source; the box lies within its centers.
inline Solid turned_solid(const Grid& source, const Grid& output, const std::array<int, 3>& cells) {
  Solid solid;
  solid.low = source.world_of({1, 1, 1});
  Point3 center;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = static_cast<double>(source.dims[axis] - 2);
    solid.high[axis] = solid.low[axis] + source.spacing[axis] * (last - 1);
    center[axis] = (solid.low[axis] + solid.high[axis]) / 2;
  }
  const auto moved = jittered_lattice(cells, solid.low, solid.high, 0.1, 5).rest_positions;
  solid.scene = {"turned", jittered_lattice(cells, solid.low, solid.high, 0.1, 3),
                 scenes::rotated_45_45(moved, center), source, output};
  solid.undone = [center](const Point3& p) { return turned_back(p, center); };
  return solid;
}

/// Voxels whose center is inside the hull and has no owner, and the other way round.
struct CoverageErrors {
  std::int64_t holes = 0;
  std::int64_t spills = 0;
  std::int64_t inside = 0;  ///< voxels that are certainly inside
};

/// Compares owners with the hull, except for voxels nearer to it than `margin` [world], where the
/// result depends on the rounding of nodes.
inline CoverageErrors coverage_errors(const Solid& solid,
                                      const std::vector<std::int32_t>& owners,
                                      double margin,
                                      const std::array<std::int64_t, 3>& begin,
                                      const std::array<std::int64_t, 3>& dims) {
  CoverageErrors errors;
  std::size_t v = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i, ++v) {
        const Point3 index = {static_cast<double>(begin[0] + i), static_cast<double>(begin[1] + j),
                              static_cast<double>(begin[2] + k)};
        const Point3 p = solid.undone(solid.scene.output_grid.world_of(index));
        double depth = INFINITY;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          depth = std::min({depth, p[axis] - solid.low[axis], solid.high[axis] - p[axis]});
        }
        errors.inside += depth > margin;
        errors.holes += depth > margin && owners[v] < 0;
        errors.spills += depth < -margin && owners[v] >= 0;
      }
    }
  }
  return errors;
}

}  // namespace tetwarp::test

/// @file shape_surface.cpp
/// Closed triangle surfaces of shapes.
#include "host/scene/shapes/shape_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <map>
#include <numbers>
#include <utility>
#include <variant>
#include <vector>

#include "host/scene/shapes/ring_surface.hpp"
#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {
namespace {
// ---- ellipsoid: an icosahedron whose triangles are divided in n x n --------------------
Surface sphere_surface(int n) {
  const double g = std::numbers::phi;
  const std::array<Point3, 12> corner{{{-1, g, 0},
                                       {1, g, 0},
                                       {-1, -g, 0},
                                       {1, -g, 0},
                                       {0, -1, g},
                                       {0, 1, g},
                                       {0, -1, -g},
                                       {0, 1, -g},
                                       {g, 0, -1},
                                       {g, 0, 1},
                                       {-g, 0, -1},
                                       {-g, 0, 1}}};
  constexpr std::size_t faces[20][3] = {
      {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  Surface surface;
  // Points by the weights of the corners that they lie between, so that faces share them.
  std::map<std::array<std::array<std::size_t, 2>, 3>, std::int32_t> number;
  const auto point_of = [&](const std::size_t(&face)[3], int b, int c) {
    const std::array<int, 3> weight{n - b - c, b, c};
    std::array<std::array<std::size_t, 2>, 3> key{};
    Point3 x{0, 0, 0};
    for (std::size_t v = 0; v < 3; ++v) {
      if (weight[v] == 0) continue;
      key[v] = {face[v] + 1, static_cast<std::size_t>(weight[v])};
    }
    std::sort(key.begin(), key.end());
    const auto [found, is_new] = number.emplace(key, 0);
    if (is_new) {
      for (const auto& [corner_plus_1, share] : key) {
        if (share > 0) x = plus(x, times(static_cast<double>(share), corner[corner_plus_1 - 1]));
      }
      found->second = add_point(surface, times(1 / norm(x), x));
    }
    return found->second;
  };
  for (const auto& face : faces) {
    for (int b = 0; b < n; ++b) {
      for (int c = 0; b + c < n; ++c) {
        const std::int32_t low = point_of(face, b, c);
        const std::int32_t right = point_of(face, b + 1, c), left = point_of(face, b, c + 1);
        surface.triangles.push_back({low, right, left});
        if (b + c + 1 < n) surface.triangles.push_back({right, point_of(face, b + 1, c + 1), left});
      }
    }
  }
  return surface;
}

Surface ellipsoid_surface(const EllipsoidShape& shape, std::int64_t triangles) {
  Surface surface =
      sphere_surface(nearest_pattern(1, triangles, [](int n) { return 20.0 * n * n; }));
  for (Point3& x : surface.points) {
    for (std::size_t d = 0; d < 3; ++d) x[d] *= shape.radii[d];
  }
  return surface;
}

// ---- box: squares on six faces ----------------------------------------------------------
using BoxCells = std::array<int, 3>;

BoxCells box_cells(const Point3& length, int along_longest) {
  const double spacing = *std::max_element(length.begin(), length.end()) / along_longest;
  return {count_along(length[0], spacing), count_along(length[1], spacing),
          count_along(length[2], spacing)};
}

/// The squares of about the wanted number of triangles.
BoxCells nearest_cells(const Bounds& bounds, std::int64_t triangles) {
  const Point3 length = minus(bounds.high, bounds.low);
  return box_cells(
      length, nearest_pattern(1, triangles, [&](int n) {
        const auto c = box_cells(length, n);
        return 4.0 * (double{1} * c[0] * c[1] + double{1} * c[1] * c[2] + double{1} * c[2] * c[0]);
      }));
}

Surface box_surface(const Bounds& bounds, const BoxCells& cells) {
  const Point3 length = minus(bounds.high, bounds.low);
  Surface surface;
  std::map<std::array<int, 3>, std::int32_t> number;
  const auto point_of = [&](const std::array<int, 3>& at) {
    const auto [found, is_new] = number.emplace(at, 0);
    if (is_new) {
      Point3 x;
      for (std::size_t d = 0; d < 3; ++d) {
        x[d] = at[d] == cells[d] ? bounds.high[d] : bounds.low[d] + length[d] * at[d] / cells[d];
      }
      found->second = add_point(surface, x);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool is_high : {false, true}) {
      for (int p = 0; p < cells[u]; ++p) {
        for (int q = 0; q < cells[v]; ++q) {
          std::array<int, 3> corner{};
          corner[axis] = is_high ? cells[axis] : 0;
          std::array<std::int32_t, 4> square{};
          for (std::size_t n = 0; n < 4; ++n) {
            corner[u] = p + (n == 1 || n == 2);
            corner[v] = q + (n >= 2);
            square[n] = point_of(corner);
          }
          if (!is_high) std::swap(square[1], square[3]);
          surface.triangles.push_back({square[0], square[1], square[2]});
          surface.triangles.push_back({square[0], square[2], square[3]});
        }
      }
    }
  }
  return surface;
}
}  // namespace

Surface make_shape_surface(const Shape& shape, std::int64_t triangles, Faces faces) {
  if (const auto* s = std::get_if<EllipsoidShape>(&shape)) return ellipsoid_surface(*s, triangles);
  if (const auto* s = std::get_if<CylinderShape>(&shape)) {
    return make_ring_surface(*s, triangles, faces);
  }
  if (const auto* s = std::get_if<CapsuleShape>(&shape)) {
    return make_ring_surface(*s, triangles, faces);
  }
  if (const auto* s = std::get_if<TorusShape>(&shape)) return make_ring_surface(*s, triangles);
  if (const auto* s = std::get_if<ArcShape>(&shape)) return make_ring_surface(*s, triangles);
  if (const auto* s = std::get_if<BentStripShape>(&shape)) {
    BoxCells cells = nearest_cells(straight_bounds(*s), triangles);
    if (faces == Faces::whole) cells = {cells[0], 1, 1};
    Surface surface = box_surface(straight_bounds(*s), cells);
    for (Point3& x : surface.points) x[2] += rise_of(*s, x[0]);
    return surface;
  }
  const Bounds bounds = bounds_of(shape);
  return box_surface(bounds,
                     faces == Faces::whole ? BoxCells{1, 1, 1} : nearest_cells(bounds, triangles));
}

}  // namespace tetwarp

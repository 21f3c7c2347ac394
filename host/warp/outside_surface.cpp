/// @file outside_surface.cpp
/// Finds the triangles and sorts them by halves.
#include "host/warp/outside_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <stdexcept>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
using Face = std::array<std::int32_t, 3>;

std::vector<Face> faces_of_one(const Mesh& mesh) {
  std::vector<std::array<std::int32_t, 4>> tets = mesh.tets;
  for (auto& tet : tets) std::ranges::sort(tet);
  std::ranges::sort(tets);
  tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
  std::vector<Face> faces;
  faces.reserve(4 * tets.size());
  for (const auto& [a, b, c, d] : tets) {
    faces.insert(faces.end(), {{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}});
  }
  std::ranges::sort(faces);
  std::vector<Face> alone;
  for (auto face = faces.begin(); face != faces.end();) {
    const auto next = std::find_if(face, faces.end(), [&](const Face& f) { return f != *face; });
    if (next - face == 1) alone.push_back(*face);
    face = next;
  }
  return alone;
}

/// Sorts triangles so that those of each leaf are near each other: halves at the median along the
/// longest side of the box of their centers.
struct LeafOrder {
  const std::vector<Point3>& centers;
  std::vector<std::int32_t>& order;
  std::int64_t leaves;

  std::ptrdiff_t first_of(std::int64_t leaf) const { return std::ssize(order) * leaf / leaves; }

  void sort(std::int64_t begin, std::int64_t end) {
    if (end - begin < 2) return;
    const std::int64_t middle = (begin + end) / 2;
    const auto first = order.begin() + first_of(begin), last = order.begin() + first_of(end);
    Point3 low = at(centers, *first), high = low;
    for (auto t = first; t != last; ++t) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], at(centers, *t)[axis]);
        high[axis] = std::max(high[axis], at(centers, *t)[axis]);
      }
    }
    const Point3 size = minus(high, low);
    const auto axis = static_cast<std::size_t>(std::ranges::max_element(size) - size.begin());
    std::nth_element(first, order.begin() + first_of(middle), last,
                     [&](std::int32_t a, std::int32_t b) {
                       const double x = at(centers, a)[axis], y = at(centers, b)[axis];
                       return x < y || (x == y && a < b);
                     });
    sort(begin, middle);
    sort(middle, end);
  }
};
}  // namespace

OutsideSurface make_outside_surface(const Mesh& mesh) {
  const std::vector<Face> faces = faces_of_one(mesh);
  if (faces.empty()) {
    throw std::invalid_argument(
        "mesh: every triangle belongs to two tetrahedra: it has no surface from which voxels "
        "outside could take displacements");
  }
  constexpr std::int64_t leaf_triangles = 4;
  OutsideSurface surface;
  surface.leaves = 1;
  while (leaf_triangles * surface.leaves < std::ssize(faces)) surface.leaves *= 2;
  std::vector<Point3> centers;
  centers.reserve(faces.size());
  for (const Face& face : faces) {
    Point3 center{0, 0, 0};
    for (const std::int32_t node : face) {
      center = plus(center, times(1.0 / 3, at(mesh.rest_positions, node)));
    }
    centers.push_back(center);
  }
  std::vector<std::int32_t> order(faces.size());
  std::iota(order.begin(), order.end(), 0);
  LeafOrder{centers, order, surface.leaves}.sort(0, surface.leaves);
  std::vector<std::int32_t> place(mesh.rest_positions.size(), -1);
  for (const std::int32_t number : order) {
    Face face = faces[static_cast<std::size_t>(number)];
    for (std::int32_t& node : face) {
      std::int32_t& known = place[static_cast<std::size_t>(node)];
      if (known < 0) {
        known = static_cast<std::int32_t>(surface.nodes.size());
        surface.nodes.push_back(node);
      }
      node = known;
    }
    surface.triangles.push_back(face);
  }
  return surface;
}

}  // namespace tetwarp

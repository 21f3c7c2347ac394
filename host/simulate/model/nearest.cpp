/// @file nearest.cpp
/// Nearest points of edges, triangles and tetrahedra, and the search through the tree.
#include "host/simulate/model/nearest.hpp"

#include <algorithm>
#include <limits>

namespace tetwarp {
namespace {

/// The nearest of the faces that lack one corner each.
template <std::size_t corners>
NearestPoint<corners> nearest_face(const std::array<Point3, corners>& item, const Point3& point) {
  NearestPoint<corners> best{0, {}, std::numeric_limits<double>::infinity()};
  for (std::size_t missing = 0; missing < corners; ++missing) {
    std::array<Point3, corners - 1> face;
    for (std::size_t c = 0, k = 0; c < corners; ++c) {
      if (c != missing) face[k++] = item[c];
    }
    const auto found = nearest_on(face, point);
    if (!(found.distance < best.distance)) continue;
    best.distance = found.distance;
    for (std::size_t c = 0, k = 0; c < corners; ++c) {
      best.weight[c] = c == missing ? 0 : found.weight[k++];
    }
  }
  return best;
}

}  // namespace

NearestPoint<2> nearest_on(const std::array<Point3, 2>& edge, const Point3& point) {
  const Point3 along = minus(edge[1], edge[0]);
  const double square = dot(along, along);
  const double t =
      square > 0 ? std::clamp(dot(minus(point, edge[0]), along) / square, 0.0, 1.0) : 0.0;
  const Point3 foot = plus(times(1 - t, edge[0]), times(t, edge[1]));
  return {0, {1 - t, t}, norm(minus(point, foot))};
}

NearestPoint<3> nearest_on(const std::array<Point3, 3>& triangle, const Point3& point) {
  const Point3 u = minus(triangle[1], triangle[0]), v = minus(triangle[2], triangle[0]);
  const Point3 normal = cross(u, v), x = minus(point, triangle[0]);
  const double square = dot(normal, normal);
  if (square > 0) {
    const double b = dot(cross(x, v), normal) / square, c = dot(cross(u, x), normal) / square;
    if (b >= 0 && c >= 0 && b + c <= 1) {
      const Point3 foot = plus(times(b, u), times(c, v));
      return {0, {1 - b - c, b, c}, norm(minus(x, foot))};
    }
  }
  return nearest_face(triangle, point);
}

NearestPoint<4> nearest_on(const std::array<Point3, 4>& tet, const Point3& point) {
  const double whole = tet_volume(tet[0], tet[1], tet[2], tet[3]);
  if (whole != 0) {
    NearestPoint<4> inside{0, {}, 0};
    bool is_inside = true;
    for (std::size_t c = 0; c < 4; ++c) {
      auto part = tet;
      part[c] = point;
      inside.weight[c] = tet_volume(part[0], part[1], part[2], part[3]) / whole;
      is_inside = is_inside && inside.weight[c] >= 0;
    }
    if (is_inside) return inside;
  }
  return nearest_face(tet, point);
}

template <std::size_t corners>
NearestItems<corners>::NearestItems(const std::vector<Point3>& points,
                                    const std::vector<Cell>& items)
    : points_(points), items_(items), tree_(boxes_of(points, items)) {}

template <std::size_t corners>
NearestPoint<corners> NearestItems<corners>::find(const Point3& point) const {
  NearestPoint<corners> best{-1, {}, std::numeric_limits<double>::infinity()};
  tree_.visit_near(point, best.distance, [&](std::int32_t item) {
    std::array<Point3, corners> places;
    for (std::size_t c = 0; c < corners; ++c) places[c] = at(points_, at(items_, item)[c]);
    auto found = nearest_on(places, point);
    const bool is_nearer =
        found.distance < best.distance || (found.distance == best.distance && item < best.item);
    if (!is_nearer) return;
    found.item = item;
    best = found;
  });
  return best;
}

template class NearestItems<3>;
template class NearestItems<4>;

}  // namespace tetwarp

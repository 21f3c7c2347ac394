/// @file near_pair.cpp
/// Weights of the nearest points of two features.
#include "host/simulate/surfaces/near_pair.hpp"

#include <tuple>
#include <type_traits>

#include "host/base/point3.hpp"
#include "host/base/vector_view.hpp"
#include "kernels/collide/pair_touch.hpp"

namespace tetwarp {
namespace {

/// The features as pair_touch.hpp reads them.
CollideView features_of(const CollisionSurfaces& surfaces) {
  const auto corners = [](const auto& list) {
    using Item = typename std::decay_t<decltype(list)>::value_type;
    const auto count = static_cast<std::int64_t>(std::tuple_size_v<Item> * list.size());
    return View<const std::int32_t>{list.empty() ? nullptr : list.front().data(), count};
  };
  CollideView features{};
  features.vertex_body = view_of(surfaces.vertex_body);
  features.vertex_radius = view_of(surfaces.vertex_radius);
  features.edges = corners(surfaces.edges);
  features.edge_radius = view_of(surfaces.edge_radius);
  features.triangles = corners(surfaces.triangles);
  features.plane_body = view_of(surfaces.plane_body);
  return features;
}

}  // namespace

NearPair near_pair(const TouchingPair& pair,
                   const CollisionSurfaces& surfaces,
                   const SurfacePlaces& places) {
  const CollideView features = features_of(surfaces);
  const FeaturePair of{pair.kind, pair.a, pair.b};
  const PairVertices own = vertices_of(features, of);
  NearPair near;
  bodies_of(features, of, near.bodies.data());
  double radii[2];
  radii_of(features, of, radii);
  if (pair.kind == PairKind::vertex_plane) {
    const Point3& vertex = at(places.vertices, pair.a);
    const PlanePlace& plane = at(places.planes, pair.b);
    const double height = dot(plane.normal, minus(vertex, plane.point));
    near.vertex[0] = pair.a;
    near.weight[0] = 1;
    near.normal = plane.normal;
    near.distance = height - radii[0];
    near.place = minus(vertex, times((height + radii[0]) / 2, plane.normal));
    return near;
  }
  const double* x[4] = {};
  for (int k = 0; k < own.count; ++k) x[k] = at(places.vertices, own.vertex[k]).data();
  axis_distance(pair.kind, x, near.weight.data());
  Point3 point[2] = {};
  for (int k = 0; k < own.count; ++k) {
    const auto n = static_cast<std::size_t>(k);
    const bool is_of_b = k >= own.count_a;
    near.vertex[n] = own.vertex[k];
    point[is_of_b] =
        plus(point[is_of_b], times(near.weight[n], at(places.vertices, own.vertex[k])));
    if (is_of_b) near.weight[n] = -near.weight[n];
  }
  const Point3 apart = minus(point[0], point[1]);
  const double length = norm(apart);
  near.normal = unit(apart);
  near.distance = length - radii[0] - radii[1];
  near.place = plus(point[1], times((length - radii[0] + radii[1]) / 2, near.normal));
  return near;
}

bool crosses(
    const Point3& from, const Point3& to, const Point3& a, const Point3& b, const Point3& c) {
  // Ends on different sides of the plane, and the line on the same side of all three edges.
  const double start = tet_volume(from, a, b, c), end = tet_volume(to, a, b, c);
  if ((start > 0 && end > 0) || (start < 0 && end < 0)) return false;
  // If all points lie in one plane within rounding, the signs of the volumes mean nothing.
  double extent = 0, largest = 0;
  for (const Point3* x : {&from, &to, &b, &c}) {
    extent = std::max(extent, norm(minus(*x, a)));
    largest = std::max(largest, norm(*x));
  }
  const double rounding = 1e-14 * (largest + extent) * extent * extent;
  if (std::abs(start) <= rounding && std::abs(end) <= rounding) return false;
  const double x = tet_volume(from, to, a, b), y = tet_volume(from, to, b, c),
               z = tet_volume(from, to, c, a);
  return (x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0);
}

}  // namespace tetwarp

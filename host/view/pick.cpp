/// @file pick.cpp
/// Rays against triangles: Moeller and Trumbore, Journal of Graphics Tools 2(1), 1997.
#include "host/view/pick.hpp"

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
/// Lengths of the direction to a triangle.
std::optional<double> meet(const std::array<Point3, 3>& corner,
                           const Point3& origin,
                           const Point3& direction) {
  const Point3 u = minus(corner[1], corner[0]), v = minus(corner[2], corner[0]);
  const Point3 p = cross(direction, v);
  const double determinant = dot(u, p);
  if (determinant == 0) return std::nullopt;
  const Point3 s = minus(origin, corner[0]), q = cross(s, u);
  const double a = dot(s, p) / determinant, b = dot(direction, q) / determinant;
  if (!(a >= 0 && b >= 0 && a + b <= 1)) return std::nullopt;
  const double distance = dot(v, q) / determinant;
  if (!(distance > 0)) return std::nullopt;
  return distance;
}
}  // namespace

std::optional<Pick> pick(const std::vector<std::vector<Point3>>& points,
                         const std::vector<Triangles>& triangles,
                         const Point3& origin,
                         const Point3& direction,
                         const std::optional<Cut>& cut) {
  std::optional<Pick> first;
  for (std::size_t body = 0; body < triangles.size() && body < points.size(); ++body) {
    for (const auto& triangle : triangles[body]) {
      std::array<Point3, 3> corner{};
      for (std::size_t c = 0; c < 3; ++c) {
        corner[c] = points[body][static_cast<std::size_t>(triangle[c])];
      }
      const auto distance = meet(corner, origin, direction);
      if (!distance || (first && *distance >= first->distance)) continue;
      const Point3 point = plus(origin, times(*distance, direction));
      if (cut && dot(minus(point, cut->point), cut->normal) > 0) continue;
      first = Pick{body, point, *distance};
    }
  }
  return first;
}

}  // namespace tetwarp::view

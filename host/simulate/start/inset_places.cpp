/// @file inset_places.cpp
/// Moves vertices against the mean normal of the triangles around them.
#include "host/simulate/start/inset_places.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
constexpr double rounding_share = 1e-9;   // of the largest coordinate
constexpr double most_thicknesses = 0.1;  // of rounding
constexpr double least_cosine = 0.25;     // between the normals of a vertex and of its triangles
}  // namespace

InsetPlaces::InsetPlaces(const CollisionSurfaces& surfaces, const SurfacePlaces& given)
    : surfaces_(surfaces),
      given_(given),
      places_(given),
      rounding_(surfaces.bodies.size(), 0),
      is_closed_(surfaces.bodies.size(), 0) {
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    set_rounding(b);
    is_closed_[b] = body.first_triangle < body.triangle_end && !has_border(body);
    if (is_inset(static_cast<std::int32_t>(b))) move_inwards(body, rounding_[b]);
  }
}

double InsetPlaces::rounding(std::int32_t body) const {
  return at(rounding_, body);
}
bool InsetPlaces::is_closed(std::int32_t body) const {
  return at(is_closed_, body) != 0;
}
bool InsetPlaces::is_inset(std::int32_t body) const {
  const CollisionBody& of = at(surfaces_.bodies, body);
  return of.first_triangle < of.triangle_end && (of.is_rigid || is_closed(body));
}

void InsetPlaces::set_rounding(std::size_t body) {
  const CollisionBody& of = surfaces_.bodies[body];
  double largest = 0;
  for (std::int32_t v = of.first_vertex; v < of.vertex_end; ++v) {
    const double radius = at(surfaces_.vertex_radius, v);
    for (const double x : at(given_.vertices, v))
      largest = std::max(largest, std::fabs(x) + radius);
  }
  rounding_[body] = std::min(rounding_share * largest, most_thicknesses * surfaces_.thickness);
}

/// Whether an edge has more triangles on one of its sides than on the other.
bool InsetPlaces::has_border(const CollisionBody& body) const {
  std::vector<std::array<std::int32_t, 3>> half_edges;  // low, high, direction
  half_edges.reserve(3 * index_of(body.triangle_end - body.first_triangle));
  for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
    const auto& corner = at(surfaces_.triangles, t);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t from = corner[c], to = corner[(c + 1) % 3];
      half_edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  std::sort(half_edges.begin(), half_edges.end());
  for (std::size_t e = 0; e < half_edges.size();) {
    std::int32_t balance = 0;
    const std::size_t first = e;
    for (; e < half_edges.size() && half_edges[e][0] == half_edges[first][0] &&
           half_edges[e][1] == half_edges[first][1];
         ++e) {
      balance += half_edges[e][2];
    }
    if (balance != 0) return true;
  }
  return false;
}

/// Moves all triangles around a vertex inwards by about `rounding`: in a sharp corner by less.
void InsetPlaces::move_inwards(const CollisionBody& body, double rounding) {
  const auto normal_of = [&](std::int32_t t) {
    const auto& [a, b, c] = at(surfaces_.triangles, t);
    const Point3& x = at(given_.vertices, a);
    return cross(minus(at(given_.vertices, b), x), minus(at(given_.vertices, c), x));
  };
  const std::size_t count = index_of(body.vertex_end - body.first_vertex);
  std::vector<Point3> normal(count, Point3{0, 0, 0});
  std::vector<double> cosine(count, 1);
  const auto for_corners = [&](const auto& visit) {
    for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
      const Point3 own = normal_of(t);
      if (!(norm(own) > 0)) continue;
      for (const std::int32_t v : at(surfaces_.triangles, t)) {
        visit(index_of(v - body.first_vertex), own);
      }
    }
  };
  for_corners([&](std::size_t v, const Point3& own) { normal[v] = plus(normal[v], own); });
  for (Point3& n : normal) n = norm(n) > 0 ? unit(n) : Point3{0, 0, 0};
  for_corners([&](std::size_t v, const Point3& own) {
    cosine[v] = std::min(cosine[v], dot(normal[v], unit(own)));
  });
  for (std::size_t v = 0; v < count; ++v) {
    Point3& x = places_.vertices[index_of(body.first_vertex) + v];
    x = minus(x, times(rounding / std::max(cosine[v], least_cosine), normal[v]));
  }
}

}  // namespace tetwarp

/// @file near_pair.cpp
/// Weights of the nearest points of two features.
#include "host/simulate/surfaces/near_pair.hpp"

#include "host/base/point3.hpp"
#include "kernels/collide/pair_distance.hpp"

namespace tetwarp {
namespace {

class PairPoints {
 public:
  PairPoints(const TouchingPair& pair,
             const CollisionSurfaces& surfaces,
             const SurfacePlaces& places)
      : pair_(pair), surfaces_(surfaces), places_(places) {}

  NearPair make() {
    switch (pair_.kind) {
      case PairKind::vertex_face:
        vertex_face();
        break;
      case PairKind::edge_edge:
        edge_edge();
        break;
      case PairKind::vertex_edge:
        vertex_edge();
        break;
      case PairKind::vertex_vertex:
        add(pair_.a, 1);
        add(pair_.b, -1);
        radius_a_ = at(surfaces_.vertex_radius, pair_.a);
        radius_b_ = at(surfaces_.vertex_radius, pair_.b);
        set_bodies(pair_.a, pair_.b);
        break;
      case PairKind::vertex_plane:
        vertex_plane();
        return result_;
    }
    finish();
    return result_;
  }

 private:
  const Point3& place(std::int32_t vertex) const { return at(places_.vertices, vertex); }
  const double* place_of(std::int32_t vertex) const { return place(vertex).data(); }

  /// Adds a vertex of a with the weight, or one of b with minus the weight.
  void add(std::int32_t vertex, double weight) {
    const bool is_of_a = count_ < of_a_;
    Point3& point = is_of_a ? point_a_ : point_b_;
    point = plus(point, times(is_of_a ? weight : -weight, place(vertex)));
    result_.vertex[count_] = vertex;
    result_.weight[count_++] = weight;
  }

  void set_bodies(std::int32_t vertex_a, std::int32_t vertex_b) {
    result_.bodies = {at(surfaces_.vertex_body, vertex_a), at(surfaces_.vertex_body, vertex_b)};
  }

  void vertex_face() {
    const auto& corners = at(surfaces_.triangles, pair_.b);
    double weight[3];
    vertex_face_distance(place_of(pair_.a), place_of(corners[0]), place_of(corners[1]),
                         place_of(corners[2]), weight);
    add(pair_.a, 1);
    for (std::size_t c = 0; c < 3; ++c) add(corners[c], -weight[c]);
    radius_a_ = at(surfaces_.vertex_radius, pair_.a);
    set_bodies(pair_.a, corners[0]);
  }

  void edge_edge() {
    const auto& a = at(surfaces_.edges, pair_.a);
    const auto& b = at(surfaces_.edges, pair_.b);
    double s = 0, t = 0;
    edge_edge_distance(place_of(a[0]), place_of(a[1]), place_of(b[0]), place_of(b[1]), &s, &t);
    of_a_ = 2;
    add(a[0], 1 - s);
    add(a[1], s);
    add(b[0], t - 1);
    add(b[1], -t);
    radius_a_ = at(surfaces_.edge_radius, pair_.a);
    radius_b_ = at(surfaces_.edge_radius, pair_.b);
    set_bodies(a[0], b[0]);
  }

  void vertex_edge() {
    const auto& b = at(surfaces_.edges, pair_.b);
    double s = 0, t = 0;
    const double* const vertex = place_of(pair_.a);
    edge_edge_distance(vertex, vertex, place_of(b[0]), place_of(b[1]), &s, &t);
    add(pair_.a, 1);
    add(b[0], t - 1);
    add(b[1], -t);
    radius_a_ = at(surfaces_.vertex_radius, pair_.a);
    radius_b_ = at(surfaces_.edge_radius, pair_.b);
    set_bodies(pair_.a, b[0]);
  }

  void vertex_plane() {
    const PlanePlace& plane = at(places_.planes, pair_.b);
    add(pair_.a, 1);
    radius_a_ = at(surfaces_.vertex_radius, pair_.a);
    const double height = dot(plane.normal, minus(place(pair_.a), plane.point));
    result_.normal = plane.normal;
    result_.distance = height - radius_a_;
    result_.place = minus(place(pair_.a), times((height + radius_a_) / 2, plane.normal));
    result_.bodies = {at(surfaces_.vertex_body, pair_.a), at(surfaces_.plane_body, pair_.b)};
  }

  void finish() {
    const Point3 apart = minus(point_a_, point_b_);
    const double length = norm(apart);
    result_.normal = unit(apart);
    result_.distance = length - radius_a_ - radius_b_;
    result_.place = plus(point_b_, times((length - radius_a_ + radius_b_) / 2, result_.normal));
  }

  const TouchingPair& pair_;
  const CollisionSurfaces& surfaces_;
  const SurfacePlaces& places_;
  NearPair result_;
  std::size_t count_ = 0;
  std::size_t of_a_ = 1;  ///< vertices of a
  Point3 point_a_{0, 0, 0}, point_b_{0, 0, 0};
  double radius_a_ = 0, radius_b_ = 0;
};

}  // namespace

NearPair near_pair(const TouchingPair& pair,
                   const CollisionSurfaces& surfaces,
                   const SurfacePlaces& places) {
  return PairPoints(pair, surfaces, places).make();
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

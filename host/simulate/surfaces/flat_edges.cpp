/// @file flat_edges.cpp
/// Joins triangles of one plane to faces, and marks edges and vertices within these.
#include "host/simulate/surfaces/flat_edges.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "host/base/disjoint_sets.hpp"
#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {

class FlatFaces {
 public:
  FlatFaces(const CollisionSurfaces& surfaces,
            const CollisionBody& body,
            std::span<const Point3> position,
            double tolerance)
      : surfaces_(surfaces), body_(body), position_(position), tolerance_(tolerance) {
    for (std::int32_t t = body.first_triangle; t < body.triangle_end; ++t) {
      const auto corner = corners(t);
      const Point3 normal = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
      area_.push_back(norm(normal));
      normal_.push_back(area_.back() > 0 ? unit(normal) : Point3{0, 0, 0});
    }
    list_sides();
    join();
    check();
  }

  void mark(std::vector<std::uint8_t>& is_flat) const {
    for (const auto& [edge, sides] : sides_) {
      const std::size_t face = face_[sides[0]];
      if (sides[1] != none && face == face_[sides[1]] && is_flat_[face] != 0) {
        is_flat[index_of(edge)] = 1;
      }
    }
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  std::array<Point3, 3> corners(std::int32_t triangle) const {
    std::array<Point3, 3> corner;
    for (std::size_t c = 0; c < 3; ++c) {
      corner[c] =
          position_[index_of(surfaces_.triangles[index_of(triangle)][c] - body_.first_vertex)];
    }
    return corner;
  }
  std::array<Point3, 3> corners_of(std::size_t own) const {
    return corners(body_.first_triangle + static_cast<std::int32_t>(own));
  }

  /// The triangles of each edge, `none` where it has one; edges of more than two are left out.
  void list_sides() {
    using Key = std::array<std::int32_t, 2>;
    std::vector<std::pair<Key, std::size_t>> uses;
    for (std::size_t t = 0; t < area_.size(); ++t) {
      const auto& v = surfaces_.triangles[index_of(body_.first_triangle) + t];
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [low, high] = std::minmax(v[c], v[(c + 1) % 3]);
        uses.push_back({{low, high}, t});
      }
    }
    std::sort(uses.begin(), uses.end());
    for (std::int32_t e = body_.first_edge; e < body_.edge_end; ++e) {
      const auto& [v, w] = surfaces_.edges[index_of(e)];
      const auto own = std::ranges::equal_range(uses, Key{std::min(v, w), std::max(v, w)}, {},
                                                &std::pair<Key, std::size_t>::first);
      if (own.empty() || own.size() > 2) continue;
      sides_.push_back({e, {own[0].second, own.size() == 2 ? own[1].second : none}});
    }
  }

  double height(const Point3& x, std::size_t triangle) const {
    return std::abs(dot(normal_[triangle], minus(x, corners_of(triangle)[0])));
  }
  bool is_on_plane(std::size_t triangle, std::size_t of) const {
    const auto corner = corners_of(triangle);
    return std::ranges::all_of(corner,
                               [&](const Point3& x) { return height(x, of) <= tolerance_; });
  }

  /// Joins neighboring triangles on one plane to faces.
  void join() {
    DisjointSets faces(area_.size());
    for (const auto& [edge, sides] : sides_) {
      const auto [a, b] = sides;
      if (b == none || !(dot(normal_[a], normal_[b]) > 0)) continue;
      if (!is_on_plane(a, b) || !is_on_plane(b, a)) continue;
      faces.unite(a, b);
    }
    for (std::size_t t = 0; t < area_.size(); ++t) face_.push_back(faces.root_of(t));
  }

  /// Marks faces that are flat as a whole: many triangles that bend by little each are not.
  void check() {
    std::vector<std::size_t> largest(face_.size());
    std::iota(largest.begin(), largest.end(), std::size_t{0});
    for (std::size_t t = 0; t < face_.size(); ++t) {
      if (area_[t] > area_[largest[face_[t]]]) largest[face_[t]] = t;
    }
    is_flat_.assign(face_.size(), 1);
    for (std::size_t t = 0; t < face_.size(); ++t) {
      const std::size_t plane = largest[face_[t]];
      if (!is_on_plane(t, plane) || !(dot(normal_[t], normal_[plane]) > 0)) is_flat_[face_[t]] = 0;
    }
  }

  const CollisionSurfaces& surfaces_;
  const CollisionBody& body_;
  std::span<const Point3> position_;
  double tolerance_;
  std::vector<double> area_;    ///< [triangles of the body] twice the area
  std::vector<Point3> normal_;  ///< [triangles] unit; 0 of a triangle without area
  std::vector<std::pair<std::int32_t, std::array<std::size_t, 2>>> sides_;
  std::vector<std::size_t> face_;      ///< [triangles] first triangle of its face
  std::vector<std::uint8_t> is_flat_;  ///< [triangles] of the first triangle of each face
};

}  // namespace

void mark_flat_edges(CollisionSurfaces& surfaces,
                     const CollisionBody& body,
                     std::span<const Point3> position,
                     double tolerance) {
  FlatFaces(surfaces, body, position, tolerance).mark(surfaces.edge_is_flat);
  const auto mark_ends = [&](bool of_flat, std::uint8_t mark) {
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      if ((surfaces.edge_is_flat[index_of(e)] != 0) != of_flat) continue;
      for (const std::int32_t v : surfaces.edges[index_of(e)]) {
        surfaces.vertex_is_flat[index_of(v)] = mark;
      }
    }
  };
  mark_ends(true, 1);
  mark_ends(false, 0);
}

}  // namespace tetwarp

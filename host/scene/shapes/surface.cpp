/// @file surface.cpp
/// Finds outer triangles, and checks areas and edges.
#include "host/scene/shapes/surface.hpp"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
using Triangle = std::array<std::int32_t, 3>;

/// A directed edge of a triangle under its undirected key.
struct HalfEdge {
  std::int32_t low, high;
  bool is_forward;  ///< from low to high
  auto operator<=>(const HalfEdge&) const = default;
};

std::vector<HalfEdge> sorted_edges(const std::vector<Triangle>& triangles) {
  std::vector<HalfEdge> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      const std::int32_t a = triangle[n], b = triangle[(n + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b});
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

double twice_area(const Surface& surface, const Triangle& triangle) {
  const Point3& a = at(surface.points, triangle[0]);
  return norm(
      cross(minus(at(surface.points, triangle[1]), a), minus(at(surface.points, triangle[2]), a)));
}
}  // namespace

std::vector<Triangle> boundary_triangles(const std::vector<std::array<std::int32_t, 4>>& tets) {
  constexpr std::size_t outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  struct Face {
    Triangle key;
    std::uint64_t place;  ///< 4 tetrahedron + face
    bool operator<(const Face& other) const {
      return std::pair(key, place) < std::pair(other.key, other.place);
    }
  };
  std::vector<Face> faces;
  faces.reserve(4 * tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t f = 0; f < 4; ++f) {
      Triangle key{tets[t][outward[f][0]], tets[t][outward[f][1]], tets[t][outward[f][2]]};
      std::sort(key.begin(), key.end());
      faces.push_back({key, faces.size()});
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint64_t> places;
  for (std::size_t f = 0; f < faces.size();) {
    std::size_t end = f + 1;
    while (end < faces.size() && faces[end].key == faces[f].key) ++end;
    if (end == f + 1) places.push_back(faces[f].place);
    f = end;
  }
  std::sort(places.begin(), places.end());
  std::vector<Triangle> triangles;
  triangles.reserve(places.size());
  for (const std::uint64_t place : places) {
    const auto& tet = tets[place / 4];
    const auto& face = outward[place % 4];
    triangles.push_back({tet[face[0]], tet[face[1]], tet[face[2]]});
  }
  return triangles;
}

std::vector<std::int32_t> nodes_of(const std::vector<Triangle>& triangles) {
  std::vector<std::int32_t> nodes;
  nodes.reserve(3 * triangles.size());
  for (const Triangle& triangle : triangles) {
    nodes.insert(nodes.end(), triangle.begin(), triangle.end());
  }
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

Surface surface_of(const std::vector<Point3>& nodes, std::vector<Triangle> triangles) {
  std::vector<std::int32_t> number(nodes.size(), -1);
  Surface surface;
  for (const std::int32_t node : nodes_of(triangles)) {
    number[static_cast<std::size_t>(node)] = static_cast<std::int32_t>(surface.points.size());
    surface.points.push_back(at(nodes, node));
  }
  for (Triangle& triangle : triangles) {
    for (std::int32_t& node : triangle) node = at(number, node);
  }
  surface.triangles = std::move(triangles);
  return surface;
}

double volume_of(const Surface& surface) {
  if (surface.points.empty()) return 0;
  const Point3& apex = surface.points.front();
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    sum += tet_volume(apex, at(surface.points, a), at(surface.points, b), at(surface.points, c));
  }
  return sum;
}

void check_areas(const std::string& place, const Surface& surface) {
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    if (twice_area(surface, surface.triangles[t]) > 0) continue;
    fail_at(place, "triangle " + std::to_string(t) + " has no area, remove it");
  }
}

void check_closed(const std::string& place, const Surface& surface) {
  const std::vector<HalfEdge> edges = sorted_edges(surface.triangles);
  for (std::size_t e = 0; e < edges.size();) {
    const HalfEdge edge = edges[e];
    std::int64_t passes[2] = {0, 0};
    for (; e < edges.size() && edges[e].low == edge.low && edges[e].high == edge.high; ++e) {
      ++passes[edges[e].is_forward];
    }
    if (passes[0] == passes[1]) continue;
    fail_at(place, "is not closed: " + std::to_string(passes[1]) +
                       " triangles pass the edge from point " + std::to_string(edge.low) +
                       " to point " + std::to_string(edge.high) + " and " +
                       std::to_string(passes[0]) +
                       " pass it back, expected as many; fill holes, join points at the same "
                       "place and turn all triangles counter-clockwise from outside");
  }
  if (!(volume_of(surface) > 0)) {
    fail_at(place,
            "encloses no positive volume; turn its triangles counter-clockwise from outside");
  }
}

}  // namespace tetwarp

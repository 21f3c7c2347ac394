/// @file surface_lattice.cpp
/// Tests boxes and tetrahedra against triangles, and winding numbers of the others.
#include "host/scene/shapes/surface_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/base/disjoint_sets.hpp"

namespace tetwarp {
namespace {
/// Share of the extents that counts as touching.
constexpr double slack = 1e-12;

struct Interval {
  double low, high;
};

template <std::size_t count>
Interval along(const std::array<Point3, count>& points, const Point3& axis) {
  Interval interval{dot(axis, points[0]), dot(axis, points[0])};
  for (const Point3& x : points) {
    const double place = dot(axis, x);
    interval.low = std::min(interval.low, place);
    interval.high = std::max(interval.high, place);
  }
  return interval;
}

bool separates(const Point3& axis,
               const std::array<Point3, 4>& tet,
               const std::array<Point3, 3>& triangle) {
  const Interval a = along(tet, axis), b = along(triangle, axis);
  const double margin =
      slack * std::max({std::abs(a.low), std::abs(a.high), std::abs(b.low), std::abs(b.high)});
  return a.low > b.high + margin || b.low > a.high + margin;
}

constexpr std::size_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
constexpr std::size_t edges[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

std::array<Point3, 4> corners_of(const TetMesh& mesh, const std::array<std::int32_t, 4>& tet) {
  return {at(mesh.nodes, tet[0]), at(mesh.nodes, tet[1]), at(mesh.nodes, tet[2]),
          at(mesh.nodes, tet[3])};
}

/// Per tetrahedron of a whole frame whether a triangle may touch it.
std::vector<std::uint8_t> touched_tets(const TetMesh& mesh,
                                       const LatticeFrame& frame,
                                       const Surface& surface) {
  std::vector<std::uint8_t> is_touched(mesh.tets.size());
  for (const auto& [p, q, r] : surface.triangles) {
    const std::array<Point3, 3> triangle{at(surface.points, p), at(surface.points, q),
                                         at(surface.points, r)};
    std::array<std::int64_t, 3> begin{}, end{};
    for (std::size_t d = 0; d < 3; ++d) {
      const auto cell_of = [&](double x) {
        return std::clamp(std::floor((x - frame.start[d]) / frame.edge[d]), 0.0,
                          static_cast<double>(frame.cells[d] - 1));
      };
      const auto [low, high] = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
      begin[d] = static_cast<std::int64_t>(cell_of(low - slack * std::abs(low)));
      end[d] = static_cast<std::int64_t>(cell_of(high + slack * std::abs(high))) + 1;
      // A triangle on the plane between two cells touches both.
      begin[d] = std::max<std::int64_t>(begin[d] - 1, 0);
    }
    for (std::int64_t c = begin[2]; c < end[2]; ++c) {
      for (std::int64_t b = begin[1]; b < end[1]; ++b) {
        for (std::int64_t a = begin[0]; a < end[0]; ++a) {
          const std::int64_t first = 5 * ((c * frame.cells[1] + b) * frame.cells[0] + a);
          for (auto t = static_cast<std::size_t>(first); t < static_cast<std::size_t>(first) + 5;
               ++t) {
            if (!is_touched[t]) is_touched[t] = may_touch(corners_of(mesh, mesh.tets[t]), triangle);
          }
        }
      }
    }
  }
  return is_touched;
}
}  // namespace

bool may_touch(const std::array<Point3, 4>& tet, const std::array<Point3, 3>& triangle) {
  // Relative to a corner, so that rounding does not grow with the distance from the origin.
  std::array<Point3, 4> t{};
  std::array<Point3, 3> s{};
  for (std::size_t n = 0; n < 4; ++n) t[n] = minus(tet[n], tet[0]);
  for (std::size_t n = 0; n < 3; ++n) s[n] = minus(triangle[n], tet[0]);
  if (separates(cross(minus(s[1], s[0]), minus(s[2], s[0])), t, s)) return false;
  for (const auto& face : faces) {
    const Point3& a = t[face[0]];
    if (separates(cross(minus(t[face[1]], a), minus(t[face[2]], a)), t, s)) return false;
  }
  for (const auto& edge : edges) {
    for (std::size_t n = 0; n < 3; ++n) {
      const Point3 axis = cross(minus(t[edge[1]], t[edge[0]]), minus(s[(n + 1) % 3], s[n]));
      if (separates(axis, t, s)) return false;
    }
  }
  return true;
}

double winding_number(const Surface& surface, const Point3& point) {
  double sum = 0;
  for (const auto& [p, q, r] : surface.triangles) {
    const Point3 a = minus(at(surface.points, p), point), b = minus(at(surface.points, q), point),
                 c = minus(at(surface.points, r), point);
    const double la = norm(a), lb = norm(b), lc = norm(c);
    // Half the solid angle (Van Oosterom and Strackee 1983).
    sum += std::atan2(dot(a, cross(b, c)),
                      la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

TetMesh tets_around(const LatticeFrame& frame,
                    const Surface& surface,
                    std::vector<std::uint8_t>* is_cut) {
  TetMesh mesh = make_lattice(frame);
  const std::vector<std::uint8_t> is_touched = touched_tets(mesh, frame, surface);
  std::vector<std::uint8_t> is_kept = is_touched;
  // No triangle touches the nodes of the other tetrahedra: those that share one are inside or
  // outside together.
  DisjointSets sets(mesh.nodes.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (is_kept[t]) continue;
    for (const std::int32_t node : mesh.tets[t]) {
      sets.unite(static_cast<std::size_t>(mesh.tets[t][0]), static_cast<std::size_t>(node));
    }
  }
  std::vector<std::int8_t> is_inside(mesh.nodes.size(), -1);  // of the lowest node of a set
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (is_kept[t]) continue;
    const std::size_t root = sets.root_of(static_cast<std::size_t>(mesh.tets[t][0]));
    std::int8_t& inside = is_inside[root];
    if (inside < 0) inside = winding_number(surface, mesh.nodes[root]) > 0.5;
    is_kept[t] = inside != 0;
  }
  if (is_cut != nullptr) {
    is_cut->clear();
    for (std::size_t t = 0; t < is_kept.size(); ++t) {
      if (is_kept[t]) is_cut->push_back(is_touched[t]);
    }
  }
  keep_tets(mesh, is_kept);
  return mesh;
}

TetMesh make_surface_lattice(const std::string& place, const Surface& surface, std::int64_t cells) {
  const Bounds bounds = bounds_of(surface.points);
  const Point3 length = minus(bounds.high, bounds.low);
  const double edge = *std::max_element(length.begin(), length.end()) / static_cast<double>(cells);
  check_cells(place, {std::ceil(length[0] / edge) + 1, std::ceil(length[1] / edge) + 1,
                      std::ceil(length[2] / edge) + 1});
  return tets_around(covering_frame(bounds, {edge, edge, edge}, 0), surface);
}

}  // namespace tetwarp

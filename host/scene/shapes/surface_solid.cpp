/// @file surface_solid.cpp
/// Cuts tetrahedra by the columns below triangles.
#include "host/scene/shapes/surface_solid.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "host/base/box_tree.hpp"
#include "host/base/parallel.hpp"
#include "host/scene/shapes/lattice_search.hpp"
#include "host/scene/shapes/surface.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "kernels/warp/overlap/convex_part.hpp"

namespace tetwarp {
namespace {
constexpr double least_part = 0.01;  // of the mean fraction

using TriangleCorners = std::array<Point3, 3>;  // of a triangle

/// A tetrahedron of positive volume as a convex part.
ConvexPart part_of(const std::array<Point3, 4>& tet) {
  constexpr int loops[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  ConvexPart part{4, 0, 4, {}, {}};
  for (std::size_t c = 0; c < 4; ++c) std::ranges::copy(tet[c], part.corner[c]);
  for (int face = 0; face < 4; ++face) {
    for (int e = 0; e < 3; ++e) add_edge(part, loops[face][e], loops[face][(e + 1) % 3], face);
  }
  return part;
}

/// Volume of a part in the column below a triangle, negative where the triangle faces down.
/// @param twice_area  of the triangle seen from above, signed
double volume_below(const ConvexPart& part, const TriangleCorners& triangle, double twice_area) {
  const double sign = twice_area > 0 ? 1 : -1;
  ConvexPart parts[2];
  const ConvexPart* now = &part;
  int next = 0;
  const auto cut = [&](const Point3& normal, double offset) {
    if (now == nullptr) return;
    const bool is_left = clip_part(*now, normal.data(), offset, parts[next]);
    now = is_left ? &parts[next] : nullptr;
    next = 1 - next;
  };
  for (std::size_t c = 0; c < 3; ++c) {
    const Point3 &a = triangle[c], &b = triangle[(c + 1) % 3];
    // The same bits, but for the sign, in the triangle across the edge.
    const Point3 normal{sign * (a[1] - b[1]), sign * (b[0] - a[0]), 0};
    cut(normal, sign * (b[1] * a[0] - a[1] * b[0]));
  }
  Point3 up = cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0]));
  up = times(-1 / twice_area, up);  // height of the plane over a point, along z
  cut(up, -dot(up, triangle[0]));
  return now == nullptr ? 0 : sign * volume_of(*now);
}

/// The part of a tetrahedron within a surface. @param tree  of its triangles @param tet  corners
double volume_within(const Surface& surface,
                     const BoxTree& tree,
                     const std::array<Point3, 4>& tet) {
  std::array<Point3, 4> corners{};
  Bounds column;  // all above the tetrahedron
  for (std::size_t c = 0; c < 4; ++c) {
    corners[c] = minus(tet[c], tet[0]);
    column.include(tet[c]);
  }
  column.high[2] = std::numeric_limits<double>::infinity();
  const ConvexPart part = part_of(corners);
  double sum = 0;
  tree.visit(column, [&](std::int32_t t) {
    const auto& [p, q, r] = at(surface.triangles, t);
    const TriangleCorners triangle{minus(at(surface.points, p), tet[0]),
                                   minus(at(surface.points, q), tet[0]),
                                   minus(at(surface.points, r), tet[0])};
    const Point3 a = minus(triangle[1], triangle[0]), b = minus(triangle[2], triangle[0]);
    const double twice_area = a[0] * b[1] - a[1] * b[0];
    if (twice_area != 0) sum += volume_below(part, triangle, twice_area);
  });
  return sum;
}

/// Raises fractions to the smallest one, and scales all others for it. Those raised sum to at most
/// a hundredth of what is enclosed, so the factor is 0.99 to 1.
void raise_small(const TetMesh& mesh, double enclosed, std::vector<double>& fraction) {
  double whole = 0;
  for (const auto& tet : mesh.tets) whole += tet_volume(mesh, tet);
  const double smallest = least_part * enclosed / whole;
  for (double& share : fraction) share = std::max(share, smallest);
  scale_to_total(mesh, enclosed, {smallest, 2}, fraction);
}
}  // namespace

std::vector<double> fractions_within(const Surface& surface,
                                     const TetMesh& mesh,
                                     const std::vector<std::uint8_t>& is_cut) {
  std::vector<double> fractions(mesh.tets.size(), 1);
  const BoxTree tree(boxes_of(surface.points, surface.triangles));
  parallel_tasks(thread_count(0), std::ssize(fractions), [&](std::int64_t index) {
    const auto t = static_cast<std::size_t>(index);
    if (!is_cut[t]) return;
    const auto& [a, b, c, d] = mesh.tets[t];
    const std::array<Point3, 4> tet{at(mesh.nodes, a), at(mesh.nodes, b), at(mesh.nodes, c),
                                    at(mesh.nodes, d)};
    fractions[t] =
        std::clamp(volume_within(surface, tree, tet) / tet_volume(mesh, mesh.tets[t]), 0.0, 1.0);
  });
  return fractions;
}

ShapeLattice make_solid_lattice(const std::string& place,
                                const Surface& surface,
                                const Lattice& choice) {
  const Bounds bounds = bounds_of(surface.points);
  const Point3 length = minus(bounds.high, bounds.low);
  const double enclosed = volume_of(surface);
  const auto frame_of_edge = [&](double edge, double offset) {
    return covering_frame(bounds, {edge, edge, edge}, offset);
  };
  const auto mesh_of = [&](const LatticeFrame& frame) { return tets_around(frame, surface); };
  const ChosenLattice chosen =
      choose_lattice(place, choice, bounds, length, enclosed, frame_of_edge, mesh_of);
  ShapeLattice lattice;
  std::vector<std::uint8_t> is_cut;
  lattice.mesh = tets_around(chosen.frame, surface, &is_cut);
  lattice.fraction = fractions_within(surface, lattice.mesh, is_cut);
  raise_small(lattice.mesh, enclosed, lattice.fraction);
  for (std::size_t d = 0; d < 3; ++d) lattice.cells_across[d] = length[d] / chosen.frame.edge[d];
  return lattice;
}

}  // namespace tetwarp

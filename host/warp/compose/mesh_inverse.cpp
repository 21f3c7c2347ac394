/// @file mesh_inverse.cpp
/// Points there and back, and why those that come back elsewhere do.
#include "host/warp/compose/mesh_inverse.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <tetwarp/map_points.hpp>

#include "host/base/point3.hpp"
#include "host/warp/hex_split.hpp"

namespace tetwarp {
namespace {
/// Whether each tetrahedron is inverted; parts of hexahedra come last, tets_per_hex of each.
std::vector<bool> inverted_tets(const Mesh& mesh, const std::vector<Point3>& deformed) {
  std::vector<bool> inverted;
  for (const auto& tet : with_split_hexes(mesh).tets) {
    const auto volume = [&](const std::vector<Point3>& nodes) {
      return tet_volume(at(nodes, tet[0]), at(nodes, tet[1]), at(nodes, tet[2]), at(nodes, tet[3]));
    };
    inverted.push_back(volume(mesh.rest_positions) * volume(deformed) < 0);
  }
  return inverted;
}

template <std::size_t count>
Point3 center_of(const std::vector<Point3>& nodes, const std::array<std::int32_t, count>& cell) {
  Point3 center{0, 0, 0};
  for (const std::int32_t node : cell) center = plus(center, times(1.0 / count, at(nodes, node)));
  return center;
}

/// Nodes and centers of cells, of curved ones also those of their straight faces, where places may
/// belong to another cell after the deformation.
std::vector<Point3> points_to_check(const CurvedMesh& curved) {
  const Mesh& mesh = curved.mesh;
  std::vector<Point3> points = mesh.rest_positions;
  for (const auto& tet : mesh.tets) points.push_back(center_of(mesh.rest_positions, tet));
  for (const auto& hex : mesh.hexes) points.push_back(center_of(mesh.rest_positions, hex));
  for (std::size_t t = 0; t < curved.mid_nodes.size(); ++t) {
    const auto& tet = mesh.tets[t];
    for (std::size_t face = 0; face < 4 && is_curved(curved, t); ++face) {
      points.push_back(
          center_of(mesh.rest_positions,
                    std::array{tet[(face + 1) % 4], tet[(face + 2) % 4], tet[(face + 3) % 4]}));
    }
  }
  return points;
}

/// Whether a cell has a curved map, in place of which its straight one may be taken either way.
bool is_curved_tet(const CurvedMesh& mesh, std::size_t cell) {
  return cell < mesh.mesh.tets.size() && is_curved(mesh, cell);
}

/// Nodes of a cell; hexahedra come after all tetrahedra.
std::span<const std::int32_t> nodes_of(const Mesh& mesh, std::size_t cell) {
  const std::size_t tets = mesh.tets.size();
  if (cell < tets) return mesh.tets[cell];
  return mesh.hexes[cell - tets];
}

/// @param inverted  of inverted_tets()
bool is_inverted(const Mesh& mesh, const std::vector<bool>& inverted, std::size_t cell) {
  const std::size_t tets = mesh.tets.size();
  if (cell < tets) return inverted[cell];
  const std::size_t first = tets + (cell - tets) * std::size_t{tets_per_hex};
  for (std::size_t part = first; part < first + tets_per_hex; ++part) {
    if (inverted[part]) return true;
  }
  return false;
}

/// Whether a place may belong to one cell before and to the other one after the deformation,
/// because ownership takes straight faces in place of curved ones: they have a node in common, one
/// is a curved tetrahedron and none is inverted.
bool are_curved_neighbors(const CurvedMesh& curved,
                          const std::vector<bool>& inverted,
                          std::size_t one,
                          std::size_t other) {
  const Mesh& mesh = curved.mesh;
  if (one == other || !(is_curved_tet(curved, one) || is_curved_tet(curved, other))) return false;
  if (is_inverted(mesh, inverted, one) || is_inverted(mesh, inverted, other)) return false;
  const std::span<const std::int32_t> nodes = nodes_of(mesh, one);
  return std::ranges::find_first_of(nodes, nodes_of(mesh, other)) != nodes.end();
}
}  // namespace

InverseCheck check_inverse(const CurvedMesh& mesh, const std::vector<Point3>& deformed) {
  const std::vector<Point3> points = points_to_check(mesh);
  const MappedPoints there = map_points(mesh, deformed, points);
  const MappedPoints back = map_points(mesh, deformed, there.points, {.inverse = true});
  const Bounds box = bounds_of(mesh.mesh.rest_positions);
  const double tolerance = 1e-6 * norm(minus(box.high, box.low));
  const std::vector<bool> inverted = inverted_tets(mesh.mesh, deformed);
  InverseCheck check;
  check.inverted = std::ranges::count(inverted, true);
  check.straightened = std::max(there.straightened, back.straightened);
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (there.owners[p] < 0 || back.owners[p] < 0) continue;  // nodes of no cell, rounded rims
    ++check.points;
    const double error = norm(minus(back.points[p], points[p]));
    const auto owner = static_cast<std::size_t>(there.owners[p]);
    if (error <= tolerance) {
      check.largest_error = std::max(check.largest_error, error);
    } else if (are_curved_neighbors(mesh, inverted, owner,
                                    static_cast<std::size_t>(back.owners[p]))) {
      ++check.beside;
      check.beside_error = std::max(check.beside_error, error);
    } else if (there.owners[p] != back.owners[p] || !is_curved_tet(mesh, owner)) {
      ++check.folded;
    }
  }
  return check;
}

}  // namespace tetwarp

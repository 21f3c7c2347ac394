/// @file lattice.cpp
/// Lattices of tetrahedra, and what is left of them.
#include "host/scene/shapes/lattice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {

double tet_volume(const TetMesh& mesh, const std::array<std::int32_t, 4>& tet) {
  return tet_volume(at(mesh.nodes, tet[0]), at(mesh.nodes, tet[1]), at(mesh.nodes, tet[2]),
                    at(mesh.nodes, tet[3]));
}

LatticeFrame fitted_frame(const Bounds& bounds, const std::array<std::int64_t, 3>& cells) {
  LatticeFrame frame{cells, bounds.low, {}};
  for (std::size_t d = 0; d < 3; ++d) {
    frame.edge[d] = (bounds.high[d] - bounds.low[d]) / static_cast<double>(cells[d]);
  }
  return frame;
}

void check_cells(const std::string& place, const std::array<double, 3>& cells) {
  const double count = 5 * cells[0] * cells[1] * cells[2];
  if (!(count < std::numeric_limits<std::int32_t>::max())) {
    fail_at(place, "makes 2^31 or more tetrahedra; use larger cells");
  }
}

TetMesh make_lattice(const LatticeFrame& frame) {
  Mesh mesh = mesh_of_cells(frame, {}, LatticeDivision::five_tets);
  return {std::move(mesh.rest_positions), std::move(mesh.tets)};
}

std::vector<std::int32_t> keep_tets(TetMesh& mesh, const std::vector<std::uint8_t>& is_kept) {
  std::vector<std::int32_t> number(mesh.nodes.size(), -1);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (!is_kept[t]) continue;
    for (const std::int32_t node : mesh.tets[t]) number[static_cast<std::size_t>(node)] = 0;
    mesh.tets[kept++] = mesh.tets[t];
  }
  mesh.tets.resize(kept);
  std::int32_t next = 0;
  for (std::size_t node = 0; node < number.size(); ++node) {
    if (number[node] < 0) continue;
    mesh.nodes[static_cast<std::size_t>(next)] = mesh.nodes[node];
    number[node] = next++;
  }
  mesh.nodes.resize(static_cast<std::size_t>(next));
  for (auto& tet : mesh.tets) {
    for (std::int32_t& node : tet) node = at(number, node);
  }
  return number;
}

void map_nodes(TetMesh& mesh, const std::function<Point3(const Point3&)>& map) {
  for (Point3& node : mesh.nodes) node = map(node);
  for (auto& tet : mesh.tets) {
    if (tet_volume(mesh, tet) < 0) std::swap(tet[2], tet[3]);
  }
}

void orient_tets(const std::string& place, TetMesh& mesh) {
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    auto& tet = mesh.tets[t];
    const double volume = tet_volume(mesh, tet);
    if (volume == 0 || !std::isfinite(volume)) {
      fail_at(place, "tetrahedron " + std::to_string(t) + " (nodes " + std::to_string(tet[0]) +
                         ", " + std::to_string(tet[1]) + ", " + std::to_string(tet[2]) + ", " +
                         std::to_string(tet[3]) + ") has no volume, remove it");
    }
    if (volume < 0) std::swap(tet[2], tet[3]);
  }
}

}  // namespace tetwarp

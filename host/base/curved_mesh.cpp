/// @file curved_mesh.cpp
/// The check of a mesh with tetrahedra of ten nodes, and its division into straight ones.
#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <string>
#include <tetwarp/curved_mesh.hpp>

namespace tetwarp {

void check_mid_nodes(const Mesh& mesh, const std::vector<MidNodes>& mid_nodes) {
  if (mid_nodes.empty()) return;
  if (mid_nodes.size() != mesh.tets.size()) {
    throw std::invalid_argument("mesh: middle nodes of " + std::to_string(mid_nodes.size()) +
                                " tetrahedra, expected none or " +
                                std::to_string(mesh.tets.size()));
  }
  const auto node_count = static_cast<std::int64_t>(mesh.rest_positions.size());
  for (std::size_t tet = 0; tet < mid_nodes.size(); ++tet) {
    if (mid_nodes[tet] == no_mid_nodes) continue;
    for (const std::int32_t node : mid_nodes[tet]) {
      if (node >= 0 && node < node_count) continue;
      throw std::invalid_argument("mesh: tetrahedron " + std::to_string(tet) +
                                  " has the middle node " + std::to_string(node) +
                                  ", expected 0 to " + std::to_string(node_count - 1) +
                                  ", or -1 for all six");
    }
  }
}

std::array<std::array<std::int32_t, 4>, 8> parts_of_curved(
    const std::array<std::int32_t, 4>& corners, const MidNodes& mid_nodes) {
  constexpr std::size_t parts[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
                                       {4, 9, 5, 6}, {4, 9, 6, 7}, {4, 9, 7, 8}, {4, 9, 8, 5}};
  std::array<std::array<std::int32_t, 4>, 8> tets;
  for (std::size_t part = 0; part < 8; ++part) {
    for (std::size_t n = 0; n < 4; ++n) {
      const std::size_t node = parts[part][n];
      tets[part][n] = node < 4 ? corners[node] : mid_nodes[node - 4];
    }
  }
  return tets;
}

Mesh split_curved(const CurvedMesh& mesh) {
  Mesh split = {mesh.mesh.rest_positions, {}, mesh.mesh.hexes};
  for (std::size_t tet = 0; tet < mesh.mesh.tets.size(); ++tet) {
    if (!is_curved(mesh, tet)) {
      split.tets.push_back(mesh.mesh.tets[tet]);
      continue;
    }
    std::ranges::copy(parts_of_curved(mesh.mesh.tets[tet], mesh.mid_nodes[tet]),
                      std::back_inserter(split.tets));
  }
  return split;
}

}  // namespace tetwarp

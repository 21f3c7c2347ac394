/// @file mesh.cpp
/// The check of a mesh: finite positions, and cells whose nodes exist.
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/mesh.hpp>

#include "kernels/base/hex_view.hpp"

namespace tetwarp {
namespace {
template <std::size_t nodes_per_cell>
void check_nodes(const std::vector<std::array<std::int32_t, nodes_per_cell>>& cells,
                 std::size_t nodes,
                 const std::string& what) {
  const auto node_count = static_cast<std::int64_t>(nodes);
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const std::int32_t node : cells[cell]) {
      if (node < 0 || node >= node_count) {
        throw std::invalid_argument("mesh: " + what + " " + std::to_string(cell) +
                                    " refers to node " + std::to_string(node) + ", expected 0 to " +
                                    std::to_string(node_count - 1));
      }
    }
  }
}
}  // namespace

void check_mesh(const Mesh& mesh) {
  if (mesh.cell_count() == 0) throw std::invalid_argument("mesh: no tetrahedra or hexahedra");
  constexpr std::size_t limit = std::size_t{1} << 31;
  if (mesh.rest_positions.size() >= limit || mesh.tets.size() >= limit ||
      mesh.tets.size() + tets_per_hex * mesh.hexes.size() >= limit) {
    throw std::invalid_argument("mesh: 2^31 or more nodes or tetrahedra (a hexahedron is six)");
  }
  check_nodes(mesh.tets, mesh.rest_positions.size(), "tetrahedron");
  check_nodes(mesh.hexes, mesh.rest_positions.size(), "hexahedron");
  for (std::size_t n = 0; n < mesh.rest_positions.size(); ++n) {
    for (const double coordinate : mesh.rest_positions[n]) {
      if (!std::isfinite(coordinate)) {
        throw std::invalid_argument("mesh: rest position of node " + std::to_string(n) +
                                    " is not finite");
      }
    }
  }
}

}  // namespace tetwarp

/// @file mesh.cpp
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/mesh.hpp>

namespace tetwarp {

void check_mesh(const TetMesh& mesh) {
  if (mesh.tets.empty()) throw std::invalid_argument("mesh: no tetrahedra");
  if (mesh.tets.size() >= (std::size_t{1} << 31) ||
      mesh.rest_positions.size() >= (std::size_t{1} << 31)) {
    throw std::invalid_argument("mesh: 2^31 or more nodes or tetrahedra");
  }
  const auto node_count = static_cast<std::int64_t>(mesh.rest_positions.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (const std::int32_t node : mesh.tets[t]) {
      if (node < 0 || node >= node_count) {
        throw std::invalid_argument("mesh: tetrahedron " + std::to_string(t) + " names node " +
                                    std::to_string(node) + ", expected 0 to " +
                                    std::to_string(node_count - 1));
      }
    }
  }
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

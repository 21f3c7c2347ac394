/// @file block_mesh.cpp
/// Extraction of the part of a mesh that a block needs.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tetwarp/blocks.hpp>

namespace tetwarp {

std::vector<Point3> BlockMesh::of(const std::vector<Point3>& positions) const {
  std::vector<Point3> part;
  part.reserve(nodes.size());
  for (const std::int32_t n : nodes) part.push_back(positions[static_cast<std::size_t>(n)]);
  return part;
}

BlockMesh block_mesh(const Mesh& mesh,
                     const WarpBlock& block,
                     const std::vector<MidNodes>& mid_nodes) {
  BlockMesh part;
  const auto add_tet = [&](std::size_t tet) {
    part.mesh.tets.push_back(mesh.tets[tet]);
    if (!mid_nodes.empty()) part.mid_nodes.push_back(mid_nodes[tet]);
  };
  for (const std::int32_t cell : block.cells) {
    const auto c = static_cast<std::size_t>(cell);
    if (c < mesh.tets.size()) {
      add_tet(c);
    } else {
      part.mesh.hexes.push_back(mesh.hexes[c - mesh.tets.size()]);
    }
  }
  if (block.cells.empty() && !mesh.tets.empty()) add_tet(0);
  if (part.mesh.cell_count() == 0) part.mesh.hexes.push_back(mesh.hexes.front());
  std::vector<std::int32_t> place(mesh.rest_positions.size(), 0);
  const auto for_nodes = [&](auto&& visit) {
    for (auto& tet : part.mesh.tets) std::ranges::for_each(tet, visit);
    for (auto& hex : part.mesh.hexes) std::ranges::for_each(hex, visit);
    for (MidNodes& mids : part.mid_nodes) {
      if (mids != no_mid_nodes) std::ranges::for_each(mids, visit);
    }
  };
  for_nodes([&](std::int32_t& node) { place[static_cast<std::size_t>(node)] = 1; });
  for (std::size_t n = 0; n < place.size(); ++n) {
    if (place[n] == 0) continue;
    place[n] = static_cast<std::int32_t>(part.nodes.size());
    part.nodes.push_back(static_cast<std::int32_t>(n));
  }
  for_nodes([&](std::int32_t& node) { node = place[static_cast<std::size_t>(node)]; });
  part.mesh.rest_positions = part.of(mesh.rest_positions);
  return part;
}

}  // namespace tetwarp

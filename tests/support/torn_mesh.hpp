/// @file torn_mesh.hpp
/// Meshes whose parts meet with nodes of their own.
#pragma once
#include <cstdint>
#include <random>
#include <tetwarp/mesh.hpp>

namespace tetwarp::test {

/// The same tetrahedra; a corner in two gets a node of its own at the same place.
inline Mesh torn(Mesh mesh, std::uint32_t seed) {
  std::mt19937 random(seed);
  for (auto& tet : mesh.tets) {
    for (std::int32_t& node : tet) {
      if (random() % 2 == 0) continue;
      const Point3 place = mesh.rest_positions[static_cast<std::size_t>(node)];
      node = static_cast<std::int32_t>(mesh.rest_positions.size());
      mesh.rest_positions.push_back(place);
    }
  }
  return mesh;
}

}  // namespace tetwarp::test

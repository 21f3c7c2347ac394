/// @file curved_scenes.hpp
/// Meshes of ten-node tetrahedra for tests.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include <tetwarp/curved_mesh.hpp>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {

constexpr std::size_t ends_of_edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

/// A mesh with a node in the middle of every edge of its tetrahedra, after its own nodes.
inline CurvedMesh with_mid_nodes(Mesh mesh) {
  CurvedMesh curved;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  for (const auto& tet : mesh.tets) {
    MidNodes& mids = curved.mid_nodes.emplace_back();
    for (std::size_t e = 0; e < 6; ++e) {
      const std::int32_t a = tet[ends_of_edges[e][0]], b = tet[ends_of_edges[e][1]];
      const auto node = static_cast<std::int32_t>(mesh.rest_positions.size());
      const auto [found, is_new] = middles.emplace(std::minmax(a, b), node);
      mids[e] = found->second;
      if (!is_new) continue;
      Point3 middle;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        middle[axis] = (mesh.rest_positions[static_cast<std::size_t>(a)][axis] +
                        mesh.rest_positions[static_cast<std::size_t>(b)][axis]) /
                       2;
      }
      mesh.rest_positions.push_back(middle);
    }
  }
  curved.mesh = std::move(mesh);
  return curved;
}

/// Positions with all middle nodes put in the middles of their edges.
inline std::vector<Point3> straightened(const CurvedMesh& mesh, std::vector<Point3> positions) {
  for (std::size_t t = 0; t < mesh.mid_nodes.size(); ++t) {
    for (std::size_t e = 0; e < 6; ++e) {
      const auto node = [&](std::size_t end) {
        return static_cast<std::size_t>(mesh.mesh.tets[t][ends_of_edges[e][end]]);
      };
      Point3& middle = positions[static_cast<std::size_t>(mesh.mid_nodes[t][e])];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        middle[axis] = (positions[node(0)][axis] + positions[node(1)][axis]) / 2;
      }
    }
  }
  return positions;
}

/// Positions moved at random by up to `amount` along each axis.
inline std::vector<Point3> shaken(std::vector<Point3> positions,
                                  double amount,
                                  std::uint64_t seed) {
  for (std::size_t n = 0; n < positions.size(); ++n) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      positions[n][axis] += amount * (2 * scenes::uniform(seed, 3 * n + axis) - 1);
    }
  }
  return positions;
}

/// A quadratic motion without folds for coordinates up to 24, which takes integers to multiples of
/// 2^-7.
inline Point3 quadratic(const Point3& x) {
  return {x[0] + x[1] * x[1] / 64 - x[1] * x[2] / 128, x[1] + x[0] * x[2] / 128,
          x[2] + x[0] * x[0] / 64 - x[1] / 8};
}

}  // namespace tetwarp::test

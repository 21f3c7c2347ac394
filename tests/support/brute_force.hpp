/// @file brute_force.hpp
/// Ownership from its definition, for tests: node positions rounded to 2^-20 voxel, then signs of
/// determinants in 128-bit integers. Shares nothing with the kernels but the inverse of the grid.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/base/index_space.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {

__extension__ using Wide = __int128;
using Quanta = std::array<std::int64_t, 3>;
using TetQuanta = std::array<Quanta, 4>;

constexpr std::int64_t quanta = 1 << 20;  ///< per voxel

/// Six times the signed volume of a tetrahedron.
inline Wide volume6(const TetQuanta& tet) {
  Wide e[3][3];
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t axis = 0; axis < 3; ++axis) e[a][axis] = tet[a + 1][axis] - tet[0][axis];
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
         e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

/// Six times the volume of the tetrahedron, its sign made positive, with node `face` moved to x:
/// proportional to the barycentric coordinate of x.
inline Wide part6(const TetQuanta& tet, std::size_t face, const Quanta& x) {
  TetQuanta part = tet;
  part[face] = x;
  return volume6(tet) < 0 ? -volume6(part) : volume6(part);
}

/// Closed: faces, edges and nodes are inside. A flat tetrahedron has no inside.
inline bool is_inside(const TetQuanta& tet, const Quanta& x) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bool below = true, above = true;
    for (const Quanta& node : tet) {
      below = below && x[axis] < node[axis];
      above = above && x[axis] > node[axis];
    }
    if (below || above) return false;
  }
  if (volume6(tet) == 0) return false;
  for (std::size_t face = 0; face < 4; ++face) {
    if (part6(tet, face, x) < 0) return false;
  }
  return true;
}

/// Voxel center (i, j, k).
inline Quanta voxel_center(std::int64_t i, std::int64_t j, std::int64_t k) {
  return {i * quanta, j * quanta, k * quanta};
}

/// Nearest multiple of 2^-20 voxel of a world position in a grid's index space.
inline Quanta quanta_of(const IndexFromWorld& map, const Point3& world) {
  Quanta q;
  for (std::size_t row = 0; row < 3; ++row) {
    const double* w = map.linear[row];
    const double x = w[0] * (world[0] - map.origin[0]);
    const double y = w[1] * (world[1] - map.origin[1]);
    const double z = w[2] * (world[2] - map.origin[2]);
    q[row] = static_cast<std::int64_t>(std::nearbyint(((x + y) + z) * quanta));
  }
  return q;
}

/// The tetrahedra of positions in a grid's index space.
inline std::vector<TetQuanta> tets_of(const Grid& grid,
                                      const Mesh& mesh,
                                      const std::vector<Point3>& positions) {
  const IndexFromWorld map = index_from_world(grid);
  std::vector<TetQuanta> tets;
  for (const auto& nodes : mesh.tets) {
    TetQuanta tet;
    for (std::size_t a = 0; a < 4; ++a) {
      tet[a] = quanta_of(map, positions[static_cast<std::size_t>(nodes[a])]);
    }
    tets.push_back(tet);
  }
  return tets;
}

/// Lowest tetrahedron that contains x, -1 when none does.
inline std::int32_t owner_of(const std::vector<TetQuanta>& tets, const Quanta& x) {
  for (std::size_t t = 0; t < tets.size(); ++t) {
    if (is_inside(tets[t], x)) return static_cast<std::int32_t>(t);
  }
  return -1;
}

}  // namespace tetwarp::test

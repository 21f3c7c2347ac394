/// @file point_search.hpp
/// The tetrahedra that may hold a point, by a uniform grid of cubes.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

#include "kernels/base/index_space.hpp"
#include "kernels/warp/point_move.hpp"

namespace tetwarp {

/// What point_move() searches in.
struct PointSearch {
  std::vector<Node> rounded;         ///< nodes [quantum]
  std::vector<PointPlanes> planes;   ///< of each tetrahedron
  std::vector<std::int64_t> first;   ///< PointCubes::first
  std::vector<std::int32_t> listed;  ///< PointCubes::tets
  PointCubes cubes;                  ///< without these two, which an executor may copy
};

/// About two cubes per tetrahedron; fewer where large tetrahedra would be in very many of them.
/// @param map    world to the index space in which positions are rounded
/// @param nodes  [world]
/// @param tets   at least one; indices in range
/// @throws std::invalid_argument  nodes that are too far from the grid, too large tetrahedra
PointSearch make_point_search(const IndexFromWorld& map,
                              const std::vector<Point3>& nodes,
                              const std::vector<std::array<std::int32_t, 4>>& tets);

}  // namespace tetwarp

/// @file marching_tets.hpp
/// Isosurfaces by marching tetrahedra: closed by construction.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tetwarp/scene.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// The edge of a lattice that a vertex of an isosurface is on.
struct EdgeCut {
  std::array<std::int64_t, 3> inside;   ///< lattice node with level >= 0
  std::array<std::int64_t, 3> outside;  ///< lattice node with level < 0
  double t;                             ///< zero of the linear level, 0 inside to 1 outside
};

/// A triangle surface whose points are on edges of a lattice.
struct MarchedSurface {
  std::vector<EdgeCut> cuts;                           ///< one per point
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< counter-clockwise from outside
};

/// The surface between the nodes of a lattice with level >= 0 and the others, five tetrahedra a
/// box. It is closed if the outermost nodes are outside.
/// @param place       of the image, for messages
/// @param counts      nodes along each axis, two at least
/// @param read_plane  read_plane(c, levels) fills the levels of nodes (a, b, c), a fastest; called
///                    with ascending c
/// @throws std::invalid_argument  too many triangles
MarchedSurface march_tets(
    const std::string& place,
    const std::array<std::int64_t, 3>& counts,
    const std::function<void(std::int64_t c, std::vector<double>& levels)>& read_plane);

/// The number of triangles that march_tets() would make.
std::int64_t count_marched(
    const std::array<std::int64_t, 3>& counts,
    const std::function<void(std::int64_t c, std::vector<double>& levels)>& read_plane);

}  // namespace tetwarp

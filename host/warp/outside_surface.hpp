/// @file outside_surface.hpp
/// The surface of a mesh, to which voxels outside of it look for displacements.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/mesh.hpp>

namespace tetwarp {

/// The triangles that one tetrahedron alone has, in the order of the leaves of a SurfaceTree.
struct OutsideSurface {
  std::vector<std::int32_t> nodes;                     ///< their numbers in the mesh
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< numbers in `nodes`
  std::int64_t leaves = 0;                             ///< a power of two
};

/// Triangles that are near each other at rest are in one leaf. A tetrahedron that is there twice
/// counts once.
/// @param mesh  its hexahedra have been split
/// @throws std::invalid_argument  when every triangle belongs to two tetrahedra
OutsideSurface make_outside_surface(const Mesh& mesh);

}  // namespace tetwarp

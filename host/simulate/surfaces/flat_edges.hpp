/// @file flat_edges.hpp
/// Edges within the flat faces of rigid bodies.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Marks the edges of a body between triangles of one flat face: triangles that are joined by
/// edges, have normals on the same side, and whose vertices all lie on one plane. Another surface
/// touches such a face at a vertex of either, or at the outline of the face.
/// @param position   [vertices of the body] in a frame of the body [m]
/// @param tolerance  largest distance from the plane [m]
/// @param is_flat    in and out, [edges of all bodies]
void mark_flat_edges(const CollisionSurfaces& surfaces,
                     const CollisionBody& body,
                     std::span<const Point3> position,
                     double tolerance,
                     std::vector<std::uint8_t>& is_flat);

}  // namespace tetwarp

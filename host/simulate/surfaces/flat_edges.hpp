/// @file flat_edges.hpp
/// Edges within the flat faces of rigid bodies.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Marks the edges of a body between triangles of one flat face: triangles joined by edges, with
/// normals to the same side, whose vertices all lie on one plane. What touches such a face touches
/// it with a vertex, or its outline.
/// @param position   [vertices of the body] in a frame of the body [m]
/// @param tolerance  largest distance from the plane [m]
/// @param is_flat    in and out, [edges of all bodies]
void mark_flat_edges(const CollisionSurfaces& surfaces,
                     const CollisionBody& body,
                     std::span<const Point3> position,
                     double tolerance,
                     std::vector<std::uint8_t>& is_flat);

}  // namespace tetwarp

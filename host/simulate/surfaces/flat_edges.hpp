/// @file flat_edges.hpp
/// Edges and vertices within the flat faces of bodies that keep their shape.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Marks the edges of a body between triangles of one flat face: triangles that are joined by
/// edges, have normals on the same side, and whose vertices all lie on one plane. Marks vertices
/// all of whose edges are such. Another surface touches such a face at a vertex of its own, or at
/// the outline of the face.
/// @param position   [vertices of the body] in a frame of the body [m]
/// @param tolerance  largest distance from the plane [m]
/// @param surfaces   in and out: edge_is_flat and vertex_is_flat of the body
void mark_flat_edges(CollisionSurfaces& surfaces,
                     const CollisionBody& body,
                     std::span<const Point3> position,
                     double tolerance);

}  // namespace tetwarp

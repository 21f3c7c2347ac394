/// @file surface_binding.cpp
/// Surfaces that are boundaries of meshes, and others.
#include "host/view/surface_binding.hpp"

namespace tetwarp::view {

BoundPoints surface_binding(const BodyMesh& mesh) {
  const bool is_boundary = boundary_surface(mesh.mesh).points == mesh.surface.points;
  return is_boundary ? bind_boundary(mesh.mesh) : bind_points(mesh.mesh, mesh.surface.points);
}

}  // namespace tetwarp::view

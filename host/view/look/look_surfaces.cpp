/// @file look_surfaces.cpp
/// Surfaces that are boundaries of meshes, and others, as weighted means of nodes.
#include "host/view/look/look_surfaces.hpp"

#include <variant>

namespace tetwarp::view {

LookSurfaces::LookSurfaces(const Simulator& simulator)
    : simulator_(simulator),
      surfaces_(simulator.scene().bodies.size()),
      bound_(simulator.scene().bodies.size()) {
  const std::vector<Body>& bodies = simulator.scene().bodies;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto* given = std::get_if<Surface>(&bodies[b].geometry);
    const Mesh& mesh = simulator.body(b).mesh;
    if (given == nullptr || mesh.tets.empty() ||
        std::holds_alternative<std::monostate>(bodies[b].surface)) {
      continue;
    }
    surfaces_[b] = given;
    bound_[b] = bind_points(mesh, given->points);
  }
}

const Surface& LookSurfaces::drawn(std::size_t body) const {
  return surfaces_[body] != nullptr ? *surfaces_[body] : simulator_.body(body).surface;
}

BoundPoints LookSurfaces::binding(std::size_t body) const {
  if (bound_[body]) return *bound_[body];
  const BodyMesh& own = simulator_.body(body);
  const bool is_boundary = boundary_surface(own.mesh).points == own.surface.points;
  return is_boundary ? bind_boundary(own.mesh) : bind_points(own.mesh, own.surface.points);
}

std::vector<Point3> LookSurfaces::positions(std::size_t body) const {
  if (surfaces_[body] == nullptr) return simulator_.surface_positions(body);
  const std::vector<Point3> nodes = simulator_.node_positions(body);
  const BoundPoints& bound = *bound_[body];
  std::vector<Point3> points(bound.nodes.size(), Point3{0, 0, 0});
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t n = 0; n < 4; ++n) {
      const Point3& node = nodes[static_cast<std::size_t>(bound.nodes[p][n])];
      for (std::size_t d = 0; d < 3; ++d) points[p][d] += bound.weights[p][n] * node[d];
    }
  }
  return points;
}

}  // namespace tetwarp::view

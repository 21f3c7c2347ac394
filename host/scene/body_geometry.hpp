/// @file body_geometry.hpp
/// One body of a scene as nodes, tetrahedra and triangles.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {

/// A body before its selections.
struct BodyParts {
  BodyGeometry geometry;
  /// Of a given mesh or surface: number of each of its points among the nodes, -1 of points that no
  /// cell uses. Otherwise empty: nodes are numbered as they are.
  std::vector<std::int32_t> node_number;
};

/// @param place  of the body, such as bodies[2], for messages
/// @param faces  of the surface of a shape without tetrahedra for which the scene gives no surface
/// @throws std::invalid_argument  as make_scene_geometry()
BodyParts make_body_parts(const std::string& place, const Body& body, Faces faces);

}  // namespace tetwarp

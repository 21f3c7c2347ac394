/// @file body_points.hpp
/// Material points of bodies: what selections select and what the points of surfaces are bound to.
#pragma once
#include <cstdint>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

/// World position of a material point.
Point3 position_of(const ModelPoint& point, const ModelState& state, std::int32_t node_count);

/// The point of a body that a selection calls `index`: a node, or without nodes a point of its
/// surface.
ModelPoint selected_point(const Model& model,
                          const SceneGeometry& geometry,
                          std::int32_t body,
                          std::int32_t index);

/// Shares, sum 1, of selected points: by volume of the tetrahedra around nodes, by area of the
/// triangles around points; equal where none of them has any.
std::vector<double> shares_of(const BodyGeometry& geometry,
                              const std::vector<std::int32_t>& selected);

/// All points of a body's surface as material points: nodes of cloth and of the boundary of
/// tetrahedra, weights in the nearest tetrahedron where a body with tetrahedra has another surface,
/// fixed in the frame of others.
std::vector<ModelPoint> bound_surface(const Model& model,
                                      const SceneGeometry& geometry,
                                      std::int32_t body);

}  // namespace tetwarp

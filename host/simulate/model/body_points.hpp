/// @file body_points.hpp
/// Material points of bodies: what selections select, what is nearest to a place, what the points
/// of surfaces are bound to.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
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

/// All points of a body's surface as material points: nodes of cloth, weights in the nearest
/// tetrahedron of elastic and scripted bodies, fixed in the frame of others.
std::vector<ModelPoint> bound_surface(const Model& model,
                                      const SceneGeometry& geometry,
                                      std::int32_t body);

struct NearestMaterial {
  ModelPoint point;
  double distance = 0;  ///< [m]
};

/// Finds the nearest material points of bodies and obstacles at the start.
class MaterialFinder {
 public:
  MaterialFinder(const Scene& scene, const SceneGeometry& geometry, const Model& model);
  ~MaterialFinder();

  /// @param name  of a body, obstacle, or "world"
  NearestMaterial nearest(const std::string& name, const Point3& x_world);
  /// As nearest(), but of rigid bodies the point itself, also outside of their surface.
  ModelPoint fixed_at(const std::string& name, const Point3& x_world);

 private:
  struct Search;
  NearestMaterial nearest_of_body(std::int32_t body, const Point3& x_world);
  Search& search_of(std::int32_t body);

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Model& model_;
  std::vector<std::unique_ptr<Search>> searches_;  ///< [bodies, then obstacles], made when needed
};

}  // namespace tetwarp

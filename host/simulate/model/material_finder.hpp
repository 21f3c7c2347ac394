/// @file material_finder.hpp
/// The material points of bodies and obstacles nearest to a place.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"

namespace tetwarp {

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
  /// As nearest(), but for a rigid body the point of its frame at x, also outside of its surface.
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

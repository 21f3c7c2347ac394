/// @file scene_loads.hpp
/// Forces of loads on the blocks of a model.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/step/resident_state.hpp"

namespace tetwarp {

class SceneLoads {
 public:
  /// @param scene, model  kept by the caller
  SceneLoads(const Scene& scene, const SceneGeometry& geometry, const Model& model);

  /// Forces [N], of angular blocks torques [N m], of the loads that act in the step that ends at
  /// `end_time` from the positions of `state`: pressure acts along minus the normals there.
  /// @param forces  out: [block_count]
  void forces(const ModelState& state, double end_time, std::vector<Point3>& forces) const;

  /// Adds the places that forces() reads of a state.
  void add_places(StatePlaces& places) const;

 private:
  struct Place {
    std::vector<ModelPoint> points;
    std::vector<double> shares;                          ///< sum 1; of a pressure: none
    std::vector<std::array<std::int32_t, 3>> triangles;  ///< of `points`; of a pressure
  };
  void add(const ModelPoint& point,
           const Point3& force,
           const ModelState& state,
           std::vector<Point3>& forces) const;

  const Scene& scene_;
  const Model& model_;
  std::vector<Place> places_;  ///< [loads]
};

}  // namespace tetwarp

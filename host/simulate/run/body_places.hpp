/// @file body_places.hpp
/// BodyPlaces: meshes of bodies, and where their points are after the last step.
#pragma once
#include <cstddef>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/simulate/run/moving_bodies.hpp"
#include "host/simulate/state/simulated_scene.hpp"
#include "host/simulate/state/step_count.hpp"

namespace tetwarp {

/// Functions throw std::invalid_argument where there is no body of that index.
class BodyPlaces {
 public:
  /// @param scene, count, bodies  kept by the caller
  BodyPlaces(const SimulatedScene& scene, const StepCount& count, MovingBodies& bodies);

  const BodyMesh& mesh(std::size_t body) const;
  /// World positions of nodes, in memory of the back end, valid until the next step.
  PositionsView positions(std::size_t body);
  /// World positions and velocities of nodes on the host.
  std::vector<Point3> node_positions(std::size_t body);
  std::vector<Point3> node_velocities(std::size_t body);
  /// World positions of the points of BodyMesh::surface.
  std::vector<Point3> surface_positions(std::size_t body);

 private:
  void check(std::size_t body) const;
  bool is_scripted(std::size_t body) const;
  const std::vector<ModelPoint>& surface(std::size_t body);

  const SimulatedScene& scene_;
  const StepCount& count_;
  MovingBodies& bodies_;
  std::vector<BodyMesh> meshes_;
  std::vector<std::vector<ModelPoint>> surfaces_;        ///< [bodies], made when asked for
  std::vector<std::vector<Point3>> scripted_positions_;  ///< [bodies] that positions() refers to
};

}  // namespace tetwarp

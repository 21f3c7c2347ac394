/// @file view_scene.hpp
/// ViewScene: what does not change while a scene is drawn.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/make.hpp>
#include <tetwarp/scene.hpp>

#include "host/view/live_simulation.hpp"
#include "host/view/pick.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::view {

struct ViewScene {
  std::string name;
  std::vector<std::string> bodies;   ///< names
  std::vector<Triangles> triangles;  ///< [bodies] of what is drawn
  std::vector<Obstacle> obstacles;
  std::vector<VolumeBody> volumes;
  Camera camera;
  Point3 center{};  ///< of the bodies at the start [m]
  double size = 1;  ///< diagonal of their box [m]
  double max_step_seconds = 0;
};

/// @param simulation  that has not begun
/// @throws std::invalid_argument  the camera shows nothing, or is not in the scene
ViewScene view_scene_of(const LiveSimulation& simulation, const ViewOptions& options);

}  // namespace tetwarp::view

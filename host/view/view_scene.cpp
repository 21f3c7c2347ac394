/// @file view_scene.cpp
/// Reads from a simulation what its window keeps.
#include "host/view/view_scene.hpp"

#include "host/base/point3.hpp"
#include "host/view/look/scene_look.hpp"

namespace tetwarp::view {

ViewScene view_scene_of(const LiveSimulation& simulation, const ViewOptions& options) {
  const Simulator& simulator = simulation.simulator();
  ViewScene scene;
  scene.name = options.scene();
  scene.obstacles = simulator.scene().obstacles;
  for (const RestVolume& source : simulation.volumes().sources()) {
    scene.volumes.push_back(source.body);
  }
  scene.max_step_seconds = options.max_step_seconds;
  Bounds bounds;
  for (std::size_t b = 0; b < simulator.scene().bodies.size(); ++b) {
    scene.bodies.push_back(simulator.scene().bodies[b].name);
    scene.triangles.push_back(simulation.looks().drawn(b).triangles);
    for (const Point3& x : simulation.looks().positions(b)) bounds.include(x);
  }
  const double aspect = static_cast<double>(options.width) / static_cast<double>(options.height);
  scene.camera =
      chosen_camera(simulator, simulation.looks(), options.camera, options.camera_name, aspect);
  render_surfaces({}, {}, {scene.camera, 1, 1});  // throws on a camera that shows nothing
  if (bounds.high[0] >= bounds.low[0]) {
    scene.center = times(0.5, plus(bounds.low, bounds.high));
    scene.size = norm(minus(bounds.high, bounds.low));
  }
  return scene;
}

}  // namespace tetwarp::view

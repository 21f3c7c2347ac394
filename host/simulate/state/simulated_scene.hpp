/// @file simulated_scene.hpp
/// SimulatedScene: a scene and the arrays that a Simulator makes of it.
#pragma once
#include <vector>

#include <tetwarp/scene.hpp>
#include <tetwarp/simulate.hpp>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/state/added_handles.hpp"
#include "host/simulate/step/scene_loads.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Once a simulation has started, only handles are added; before, bodies that start too near each
/// other change the start of the model.
struct SimulatedScene {
  /// @throws std::invalid_argument  in one line naming the body or entry and what is wrong
  SimulatedScene(Scene scene_of_caller, const SimulateOptions& options_of_caller);
  SimulatedScene(const SimulatedScene&) = delete;
  SimulatedScene& operator=(const SimulatedScene&) = delete;

  Scene scene;  ///< with the handles that were added, after its own
  const SimulateOptions options;
  const Backend backend;         ///< cpu, cuda or reference
  const SceneGeometry geometry;  ///< refers to paths of `scene`
  Model model;
  const SceneLoads loads;
  SceneSurfaces surfaces;  ///< of the start before bodies are brought apart
  int threads = 1;
  std::vector<AddedHandle> added;  ///< the last ones of the scene
};

}  // namespace tetwarp

/// @file simulated_scene.cpp
/// Makes geometry, model and surfaces of a scene.
#include "host/simulate/state/simulated_scene.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

Scene checked(Scene scene) {
  check_scene(scene);
  return scene;
}

}  // namespace

SimulatedScene::SimulatedScene(Scene scene_of_caller, const SimulateOptions& options_of_caller)
    : scene(checked(std::move(scene_of_caller))),
      options(options_of_caller),
      backend(options.backend == Backend::automatic ? Backend::cpu : options.backend),
      geometry(make_scene_geometry(scene)),
      model(make_model(scene, geometry)),
      loads(scene, geometry, model) {
  if (options.max_iterations < 1) {
    throw std::invalid_argument("max_iterations: expected 1 or more, got " +
                                std::to_string(options.max_iterations));
  }
  if (!(options.max_step_seconds > 0)) {
    throw std::invalid_argument("max_step_seconds: expected more than 0, got " +
                                std::to_string(options.max_step_seconds));
  }
  surfaces = make_scene_surfaces(scene, geometry, model);
  threads = thread_count(options.threads);
}

}  // namespace tetwarp

/// @file scene_sharer.hpp
/// SceneSharer: scene and states of a running simulation, for the screens.
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "host/view/live_simulation.hpp"
#include "host/view/screens/shared_state.hpp"
#include "host/view/view_scene.hpp"

namespace tetwarp::view {

class SceneSharer {
 public:
  /// @param simulation  that has not begun; only simulator(), looks() and volumes() are used
  SceneSharer(const LiveSimulation& simulation, const ViewScene& scene, const ViewOptions& options);

  const SharedScene& scene() const { return scene_; }
  /// The state of the simulator, with contacts and what is held as in `frame`.
  SharedState state(const Simulator& simulator, const LiveFrame& frame) const;

 private:
  using Triad = std::array<std::size_t, 3>;  ///< points of a surface that give its pose

  SharedScene scene_;
  std::vector<std::optional<Triad>> triads_;  ///< [bodies]
};

}  // namespace tetwarp::view

/// @file scene_hand.hpp
/// SceneHand: what mouse and devices do to what a ray meets.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host/view/hand/device_hand.hpp"
#include "host/view/live_simulation.hpp"
#include "host/view/pick.hpp"
#include "host/view/view_scene.hpp"

namespace tetwarp::view {

/// Of the thread that takes the frames of the simulation.
class SceneHand {
 public:
  /// @param scene, simulation  kept by the caller
  /// @param cut  what hides bodies now
  SceneHand(const ViewScene& scene,
            LiveSimulation& simulation,
            std::function<std::optional<Cut>()> cut);

  /// What a ray meets first in the newest frame.
  std::optional<Pick> meet(const EyeRay& ray);
  void grab(const Pick& point);
  /// @param target  where the point that was grabbed is to be
  void pull(const Point3& target);
  void release();
  /// What is where the ray meets something.
  std::string probe(const EyeRay& ray);
  /// All but HandActions::probe and place. They use this.
  HandActions actions();

 private:
  const ViewScene& scene_;
  LiveSimulation& simulation_;
  std::function<std::optional<Cut>()> cut_;

  /// What the pick of a ray depends on: the ray, step and tick of the frame, the cut.
  struct PickInput {
    EyeRay ray;
    std::int64_t step = 0, tick = 0;
    std::optional<Cut> cut;

    bool operator==(const PickInput&) const = default;
  };
  std::optional<PickInput> newest_input_;  ///< a wand at rest gives the same again
  std::optional<Pick> newest_pick_;
};

}  // namespace tetwarp::view

/// @file scene_hand.cpp
/// Rays against the newest frame, and orders.
#include "host/view/hand/scene_hand.hpp"

#include <utility>

#include "host/view/overlay_text.hpp"

namespace tetwarp::view {

SceneHand::SceneHand(const ViewScene& scene,
                     LiveSimulation& simulation,
                     std::function<std::optional<Cut>()> cut)
    : scene_(scene), simulation_(simulation), cut_(std::move(cut)) {}

std::optional<Pick> SceneHand::meet(const EyeRay& ray) {
  const LiveFrame& frame = simulation_.frames().front();
  const PickInput input{ray, frame.step, frame.tick, cut_()};
  if (newest_input_ != input) {
    newest_pick_ = pick(frame.points, scene_.triangles, ray.origin, ray.direction, input.cut);
    newest_input_ = input;
  }
  return newest_pick_;
}

void SceneHand::grab(const Pick& point) {
  simulation_.give({.kind = OrderKind::grab, .body = point.body, .point = point.point});
}

void SceneHand::pull(const Point3& target) {
  simulation_.give({.kind = OrderKind::pull, .point = target});
}

void SceneHand::release() {
  simulation_.give({.kind = OrderKind::release});
}

std::string SceneHand::probe(const EyeRay& ray) {
  const auto found = meet(ray);
  if (!found) return "nothing is there";
  return probe_text(scene_, simulation_.frames().front(), *found, ray.direction);
}

HandActions SceneHand::actions() {
  return {.meet = [this](const EyeRay& ray) { return meet(ray); },
          .grab = [this](const Pick& point) { grab(point); },
          .pull = [this](const Point3& target) { pull(target); },
          .release = [this] { release(); }};
}

}  // namespace tetwarp::view

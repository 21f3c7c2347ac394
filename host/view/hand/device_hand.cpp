/// @file device_hand.cpp
/// Buttons, rays, and what is carried.
#include "host/view/hand/device_hand.hpp"

#include <algorithm>
#include <utility>

#include "host/base/point3.hpp"

namespace tetwarp::view {

DeviceHand::DeviceHand(std::vector<std::unique_ptr<InputDevice>> devices, HandActions actions)
    : actions_(std::move(actions)) {
  for (auto& device : devices) hands_.push_back({.device = std::move(device)});
}

bool DeviceHand::update(Camera& camera, const EyeRay& middle) {
  const std::vector<WandRay> rays_before = std::exchange(rays_, {});
  const std::string problems_before = std::exchange(problems_, {});
  bool has_moved = false;
  for (Held& hand : hands_) {
    read(hand);
    if (!hand.problem.empty()) problems_ += (problems_.empty() ? "" : "\n") + hand.problem;
    has_moved = steer(hand, camera, middle) || has_moved;
  }
  // The room goes with the camera.
  const RoomPlace room = actions_.place(camera);
  for (Held& hand : hands_) {
    const std::optional<DevicePose>& pose = hand.said.state.pose;
    if (pose) point(hand, place_of(*pose, room), norm(minus(camera.eye, camera.target)));
  }
  has_news_ = rays_ != rays_before || problems_ != problems_before;
  return has_moved;
}

bool DeviceHand::let_go() {
  bool has_held = false;
  for (Held& hand : hands_) {
    if (!std::exchange(hand.holds, false)) continue;
    actions_.release();
    has_held = true;
  }
  return has_held;
}

bool DeviceHand::is_simulating() const {
  return std::ranges::any_of(
      hands_, [](const Held& hand) { return hand.device && hand.device->is_simulated(); });
}

void DeviceHand::read(Held& hand) {
  if (!hand.device) return;
  const std::optional<DeviceSpan> span = hand.device->read();
  hand.said = span.value_or(DeviceSpan{});
  hand.problem = hand.device->problem();
  if (!span) hand.device.reset();
}

void DeviceHand::use_buttons(Held& hand, const EyeRay& ray) {
  const DeviceState& state = hand.said.state;
  const auto holds = [](const Held& any) { return any.holds; };
  const bool takes = state.grabs && !hand.grabs && std::ranges::none_of(hands_, holds);
  const bool probes = state.probes && !hand.probes;
  hand.grabs = state.grabs;
  hand.probes = state.probes;
  if (takes) {
    if (const auto found = actions_.meet(ray)) {
      actions_.grab(*found);
      hand.holds = true;
      hand.target = found->point;
      hand.local.reset();
    }
  }
  if (hand.holds && !hand.grabs) {
    hand.holds = false;
    actions_.release();
  }
  if (probes) actions_.probe(ray);
}

void DeviceHand::carry(Held& hand, const Point3& target) {
  if (target != hand.target) actions_.pull(hand.target = target);
}

/// The camera, or what a device without a pose holds. @returns whether the camera has moved
bool DeviceHand::steer(Held& hand, Camera& camera, const EyeRay& middle) {
  const DeviceState& state = hand.said.state;
  if (!state.pose) {
    use_buttons(hand, middle);
    hand.local.reset();
    if (hand.holds) {
      carry(hand, plus(hand.target, carried_way(camera, hand.said)));
      return false;
    }
  }
  if (norm(state.move) + norm(state.turn) <= 0) return false;
  camera = moved_camera(camera, hand.said);
  return true;
}

/// @param reach  of a ray that meets nothing [m]
void DeviceHand::point(Held& hand, const WandPlace& wand, double reach) {
  const EyeRay ray = wand.ray();
  use_buttons(hand, ray);
  if (hand.holds && hand.local) {
    carry(hand, wand.world_of(*hand.local));
  } else if (hand.holds) {
    hand.local = wand.local_of(hand.target);
  }
  Point3 end = hand.target;
  if (!hand.holds) {
    const auto found = actions_.meet(ray);
    end = found ? found->point : plus(ray.origin, times(reach, unit(ray.direction)));
  }
  if (is_in_world(wand.origin) && is_in_world(end)) rays_.push_back({wand.origin, end});
}

}  // namespace tetwarp::view

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

bool DeviceHand::update(Camera& camera, const EyeRay& middle, const RoomPlace& room) {
  const std::vector<WandRay> rays_before = std::exchange(rays_, {});
  const std::string problems_before = std::exchange(problems_, {});
  room_ = room;
  bool has_moved = false;
  for (Held& hand : hands_) {
    if (!hand.device) continue;
    const auto span = hand.device->read();
    const std::string problem = hand.device->problem();
    if (!problem.empty()) problems_ += (problems_.empty() ? "" : "\n") + problem;
    has_moved = act(hand, span.value_or(DeviceSpan{}), camera, middle) || has_moved;
    if (!span) hand.device.reset();
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

void DeviceHand::use_buttons(Held& hand, const DeviceState& state, const EyeRay& ray) {
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

/// @returns whether the camera has moved
bool DeviceHand::act(Held& hand, const DeviceSpan& span, Camera& camera, const EyeRay& middle) {
  const DeviceState& state = span.state;
  if (state.pose) {
    const WandPlace wand = place_of(*state.pose, room_);
    use_buttons(hand, state, wand.ray());
    if (hand.holds && hand.local)
      carry(hand, wand.world_of(*hand.local));
    else if (hand.holds)
      hand.local = wand.local_of(hand.target);
    Point3 end = hand.target;
    if (!hand.holds) {
      const EyeRay ray = wand.ray();
      const auto found = actions_.meet(ray);
      const double reach = norm(minus(camera.eye, camera.target));
      end = found ? found->point : plus(ray.origin, times(reach, unit(ray.direction)));
    }
    if (is_in_world(wand.origin) && is_in_world(end)) rays_.push_back({wand.origin, end});
  } else {
    use_buttons(hand, state, middle);
    hand.local.reset();
    if (hand.holds) {
      carry(hand, plus(hand.target, carried_way(camera, span)));
      return false;
    }
  }
  if (norm(state.move) + norm(state.turn) <= 0) return false;
  camera = moved_camera(camera, span);
  return true;
}

}  // namespace tetwarp::view

/// @file device_hand.cpp
/// A button takes what is in the middle of the window; while it is held, the device moves that.
#include "host/view/window/device_hand.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "host/base/point3.hpp"
#include "host/view/devices/gamepad.hpp"
#include "host/view/devices/simulated_device.hpp"
#include "host/view/devices/space_mouse.hpp"
#include "host/view/window/window_camera.hpp"

namespace tetwarp::view {
namespace {
std::unique_ptr<InputDevice> open(const std::string& name) {
  if (name == "gamepad") return open_gamepad();
  if (name == "spacemouse") return open_space_mouse();
  return std::make_unique<SimulatedDevice>(name);
}
}  // namespace

DeviceHand::DeviceHand(const std::string& names, HandActions actions)
    : actions_(std::move(actions)) {
  std::istringstream words(names);
  for (std::string name; std::getline(words, name, ',');) hands_.push_back({.device = open(name)});
}

bool DeviceHand::update(vtkCamera* camera) {
  bool has_moved = false;
  for (Held& hand : hands_) {
    if (!hand.device) continue;
    const auto span = hand.device->read();
    has_moved = act(hand, span.value_or(DeviceSpan{}), camera) || has_moved;
    if (!span) hand.device.reset();
  }
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

bool DeviceHand::act(Held& hand, const DeviceSpan& span, vtkCamera* camera) {
  const Camera now = camera_of(camera);
  const bool takes = span.state.grabs && !hand.grabs;
  hand.grabs = span.state.grabs;
  if (takes) hand.holds = actions_.grab(hand.target);
  if (hand.holds && !hand.grabs) {
    hand.holds = false;
    actions_.release();
  }
  if (hand.holds) {
    const Point3 way = carried_way(now, span);
    if (norm(way) > 0) actions_.pull(hand.target = plus(hand.target, way));
    return false;
  }
  if (norm(span.state.move) + norm(span.state.turn) <= 0) return false;
  set_camera(moved_camera(now, span), camera);
  return true;
}

}  // namespace tetwarp::view

/// @file open_devices.cpp
/// Which word is which device.
#include "host/view/devices/open_devices.hpp"

#include <sstream>
#include <string_view>

#include "host/view/devices/gamepad.hpp"
#include "host/view/devices/simulated_device.hpp"
#include "host/view/devices/space_mouse.hpp"
#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::view {
namespace {
constexpr std::string_view wand = "wand=";

std::unique_ptr<InputDevice> open_device(const std::string& name) {
  if (name == "gamepad") return open_gamepad();
  if (name == "spacemouse") return open_space_mouse();
  if (name.starts_with(wand)) return open_tracked_device(name.substr(wand.size()));
  return std::make_unique<SimulatedDevice>(name);
}
}  // namespace

std::vector<std::unique_ptr<InputDevice>> open_devices(const std::string& names) {
  std::vector<std::unique_ptr<InputDevice>> devices;
  std::istringstream words(names);
  for (std::string name; std::getline(words, name, ',');) devices.push_back(open_device(name));
  return devices;
}

}  // namespace tetwarp::view

/// @file tracked_device_novrpn.cpp
/// This program was built without VRPN.
#include <stdexcept>

#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::view {

std::unique_ptr<InputDevice> open_tracked_device(const std::string& name) {
  throw std::runtime_error(
      name +
      ": trackers need VRPN, which this program was built without; install it from "
      "github.com/vrpn/vrpn, set CMAKE_PREFIX_PATH to where it is and build again");
}

}  // namespace tetwarp::view

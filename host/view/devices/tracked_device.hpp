/// @file tracked_device.hpp
/// Trackers and wands, by VRPN.
#pragma once
#include <memory>
#include <string>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// A sensor of a tracker, whose server may come and go. Button 0 grabs, button 1 probes; axes 0 and
/// 1 move to the right and ahead, 2 and 3 turn to the right and up.
/// @param name  as tracked_names() takes it; addresses of its hosts are looked up once
/// @throws std::invalid_argument  the name is none
/// @throws std::runtime_error  there is no such host, or this program was built without VRPN
std::unique_ptr<InputDevice> open_tracked_device(const std::string& name);

}  // namespace tetwarp::view

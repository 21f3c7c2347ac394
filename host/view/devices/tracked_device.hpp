/// @file tracked_device.hpp
/// Trackers and wands, by VRPN.
#pragma once
#include <memory>
#include <string>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// A sensor of a tracker, whose server may come and go. Button 0 grabs, button 1 probes; axes 0 and
/// 1 move to the right and ahead, 2 and 3 turn to the right and up.
/// @param name  TRACKER@HOST[:PORT][#SENSOR][+BUTTONS@HOST[:PORT]]: sensor 0, and buttons and axes
///              of the tracker's own name, where nothing else is said
/// @throws std::runtime_error  the name is none, or this program was built without VRPN
std::unique_ptr<InputDevice> open_tracked_device(const std::string& name);

}  // namespace tetwarp::view

/// @file space_mouse.hpp
/// 3D mice, by the daemon spacenavd.
#pragma once
#include <memory>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// Pushing and turning the cap moves and turns; the first button grabs, the second one probes.
/// Versions of libspnav that read the environment variable SPNAV_SOCKET look for the daemon's
/// socket there.
/// @throws std::runtime_error  no daemon answers, or this program was built without libspnav
std::unique_ptr<InputDevice> open_space_mouse();

}  // namespace tetwarp::view

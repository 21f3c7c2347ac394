/// @file open_devices.hpp
/// Devices by the names of the option --devices.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// @param names  gamepad, spacemouse, wand=NAME of open_tracked_device(), or files of a
///               SimulatedDevice, with commas between them
/// @throws std::runtime_error  naming the device that is missing, and the remedy
std::vector<std::unique_ptr<InputDevice>> open_devices(const std::string& names);

}  // namespace tetwarp::view

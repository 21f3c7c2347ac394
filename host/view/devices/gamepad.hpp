/// @file gamepad.hpp
/// Gamepads, by SDL.
#pragma once
#include <memory>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// The first gamepad that is connected: the left stick and the shoulder buttons move, the right
/// stick and the triggers turn, A grabs, B probes.
/// @throws std::runtime_error  none is connected, or this program was built without SDL2
std::unique_ptr<InputDevice> open_gamepad();

}  // namespace tetwarp::view

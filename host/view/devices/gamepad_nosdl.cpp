/// @file gamepad_nosdl.cpp
/// This program was built without SDL.
#include <stdexcept>

#include "host/view/devices/gamepad.hpp"

namespace tetwarp::view {

std::unique_ptr<InputDevice> open_gamepad() {
  throw std::runtime_error(
      "gamepads need SDL2, which this program was built without; install libsdl2-dev and build "
      "again");
}

}  // namespace tetwarp::view

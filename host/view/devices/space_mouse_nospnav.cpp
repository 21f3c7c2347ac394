/// @file space_mouse_nospnav.cpp
/// This program was built without libspnav.
#include <stdexcept>

#include "host/view/devices/space_mouse.hpp"

namespace tetwarp::view {

std::unique_ptr<InputDevice> open_space_mouse() {
  throw std::runtime_error(
      "3D mice need libspnav, which this program was built without; install libspnav-dev and build "
      "again");
}

}  // namespace tetwarp::view

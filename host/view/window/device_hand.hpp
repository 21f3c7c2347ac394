/// @file device_hand.hpp
/// DeviceHand: devices that move the camera, or what they hold.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <vtkCamera.h>

#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {

/// What the window does for a device; as MouseActions.
struct HandActions {
  std::function<bool(Point3& point)> grab;  ///< what is in the middle; false: nothing is there
  std::function<void(const Point3& target)> pull;
  std::function<void()> release;
};

class DeviceHand {
 public:
  /// @param names  gamepad, spacemouse, or files of a SimulatedDevice, with commas between them
  /// @throws std::runtime_error  naming the device that is missing, and the remedy
  DeviceHand(const std::string& names, HandActions actions);

  /// Reads all devices. @returns whether the camera has moved
  bool update(vtkCamera* camera);
  /// What the devices hold is let go, also while their buttons are held. @returns whether there was
  /// anything
  bool let_go();
  /// Whether a simulated device has more to say.
  bool is_simulating() const;

 private:
  struct Held {
    std::unique_ptr<InputDevice> device;
    bool grabs = false;  ///< its button is down
    bool holds = false;  ///< and something is held
    Point3 target{};
  };
  bool act(Held& hand, const DeviceSpan& span, vtkCamera* camera);

  std::vector<Held> hands_;
  HandActions actions_;
};

}  // namespace tetwarp::view

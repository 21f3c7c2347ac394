/// @file device_hand.hpp
/// DeviceHand: devices that move the camera, or what they hold.
#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/make.hpp>

#include "host/view/devices/input_device.hpp"
#include "host/view/hand/room_place.hpp"
#include "host/view/pick.hpp"

namespace tetwarp::view {

/// What the window does for a device; as SceneHand.
struct HandActions {
  std::function<std::optional<Pick>(const EyeRay& ray)> meet;
  std::function<void(const Pick& point)> grab;
  std::function<void(const Point3& target)> pull;
  std::function<void()> release;
  std::function<void(const EyeRay& ray)> probe = {};
  std::function<RoomPlace(const Camera& camera)> place = {};  ///< of the room of tracked devices
};

/// A button takes what is in the middle of the window, or what a tracked device points at. While
/// the button is held, that goes as the device does: a tracked one carries it like a stick. One
/// device holds something at a time.
class DeviceHand {
 public:
  DeviceHand(std::vector<std::unique_ptr<InputDevice>> devices, HandActions actions);

  /// Reads all devices.
  /// @param camera  that the devices move, and with it the room of tracked ones
  /// @param middle  what the middle of the window shows
  /// @returns whether the camera has moved
  bool update(Camera& camera, const EyeRay& middle);
  /// What the devices hold is let go, also while their buttons are held. @returns whether there was
  /// anything
  bool let_go();
  /// Whether a simulated device has more to say.
  bool is_simulating() const;
  /// Whether update() has changed rays or problems.
  bool has_news() const { return has_news_; }
  /// Of tracked devices, as of update(); those that are not in the world are left out.
  const std::vector<WandRay>& rays() const { return rays_; }
  /// A line for each device that says nothing, or is gone, as of update().
  const std::string& problems() const { return problems_; }

 private:
  struct Held {
    std::unique_ptr<InputDevice> device;  ///< nothing: it is gone
    DeviceSpan said = {};                 ///< newest; nothing of a device that is gone
    std::string problem = {};             ///< of the device, also when it is gone
    bool grabs = false, probes = false;   ///< its buttons are down
    bool holds = false;                   ///< and something is held
    Point3 target{};                      ///< of what is held [world]
    std::optional<Point3> local = {};     ///< and where that is for a device with a pose
  };
  static void read(Held& hand);
  bool steer(Held& hand, Camera& camera, const EyeRay& middle);
  void point(Held& hand, const WandPlace& wand, double reach);
  void use_buttons(Held& hand, const EyeRay& ray);
  void carry(Held& hand, const Point3& target);

  std::vector<Held> hands_;
  HandActions actions_;
  std::vector<WandRay> rays_;
  std::string problems_;
  bool has_news_ = false;
};

}  // namespace tetwarp::view

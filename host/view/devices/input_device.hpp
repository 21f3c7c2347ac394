/// @file input_device.hpp
/// InputDevice: a device beside mouse and keys, and what it says.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>

#include <tetwarp/make.hpp>

namespace tetwarp::view {

/// Axes are to the right, up and towards the user, as the camera sees them.
struct DeviceState {
  Point3 move{};       ///< how far the device is pushed along each, -1 to 1
  Point3 turn{};       ///< and turned about each
  bool grabs = false;  ///< a button is held down

  bool operator==(const DeviceState&) const = default;
};

/// What a device says for so long.
struct DeviceSpan {
  DeviceState state;
  double seconds = 0;  ///< since the last call
};

/// DeviceSpan::seconds of a real device, which is asked less often where pictures take long [s].
constexpr double most_span = 0.1;

class InputDevice {
 public:
  virtual ~InputDevice() = default;
  /// Never waits. Nothing: the device is gone.
  virtual std::optional<DeviceSpan> read() = 0;
  /// Whether it is no real one: it will be gone by itself.
  virtual bool is_simulated() const { return false; }
};

/// The camera after a device moved it: it goes along with the target by half a distance of both a
/// second at most, and turns about the target by a quarter turn a second at most.
Camera moved_camera(const Camera& camera, const DeviceSpan& by);

/// How far a device takes a point that it holds: as the camera moves, seen from the camera.
Point3 carried_way(const Camera& camera, const DeviceSpan& by);

}  // namespace tetwarp::view

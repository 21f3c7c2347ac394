/// @file input_device.hpp
/// InputDevice: a device beside mouse and keys, and what it says.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>

#include <tetwarp/make.hpp>

namespace tetwarp::view {

inline constexpr double largest_world = 1e9;  ///< a coordinate [m]

/// Whether all coordinates are below largest_world.
bool is_in_world(const Point3& x);

/// Where a tracked device is, in coordinates of the room: x to the right, y up, z back.
struct DevicePose {
  Point3 position{};                           ///< [m]
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w x y z

  bool operator==(const DevicePose&) const = default;
};

/// Axes are to the right, up and towards the user, as the camera sees them.
struct DeviceState {
  Point3 move{};                        ///< how far the device is pushed along each, -1 to 1
  Point3 turn{};                        ///< and turned about each
  bool grabs = false;                   ///< a button is held down
  bool probes = false;                  ///< and another one
  std::optional<DevicePose> pose = {};  ///< of a device that is tracked

  bool operator==(const DeviceState&) const = default;
};

/// What a device says for so long.
struct DeviceSpan {
  DeviceState state;
  double seconds = 0;   ///< since the last call
  double pose_age = 0;  ///< since a tracked device said its pose [s]
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
  /// Why it says nothing now though it may again, or that it is gone, or empty.
  virtual std::string problem() const { return {}; }
};

/// A value of a stick, -1 to 1, without the part within which it rests.
double beyond_rest(double value);

/// A quaternion w x y z of length 1; nothing: it has none.
std::optional<std::array<double, 4>> unit_rotation(const std::array<double, 4>& rotation);

/// @param rotation  a quaternion w x y z of any length
/// @returns nothing where the position is not in the world or the quaternion has no length
std::optional<DevicePose> device_pose(const Point3& position,
                                      const std::array<double, 4>& rotation);

/// The camera after a device moved it: it goes along with the target by half a distance of both a
/// second at most, and turns about the target by a quarter turn a second at most.
Camera moved_camera(const Camera& camera, const DeviceSpan& by);

/// How far a device takes a point that it holds: as the camera moves, seen from the camera.
Point3 carried_way(const Camera& camera, const DeviceSpan& by);

}  // namespace tetwarp::view

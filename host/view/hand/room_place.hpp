/// @file room_place.hpp
/// RoomPlace: where a room of screens and tracked devices is in the world; WandPlace: a device in
/// it.
#pragma once
#include <array>

#include <tetwarp/volume.hpp>

#include "host/view/devices/input_device.hpp"
#include "host/view/pick.hpp"

namespace tetwarp::view {

/// Where the room is in the world, as the master's camera moves it: x maps to
/// origin + axes (x - observer).
struct RoomPlace {
  Point3 observer{};             ///< in the room
  Point3 origin{};               ///< the observer in the world
  std::array<Point3, 3> axes{};  ///< of the room in the world, as long as a meter is there

  Point3 world_of(const Point3& x) const;
  bool operator==(const RoomPlace&) const = default;
};

/// Columns of the matrix of a unit quaternion w x y z.
std::array<Point3, 3> columns_of(const std::array<double, 4>& rotation);

/// A tracked device in the world: x of the device maps to origin + axes x. It points along -z.
struct WandPlace {
  Point3 origin{};
  std::array<Point3, 3> axes{};  ///< at right angles, all of one length

  Point3 world_of(const Point3& x) const;
  Point3 local_of(const Point3& world) const;
  EyeRay ray() const;
};

/// From a wand to what it points at or holds [world].
using WandRay = std::array<Point3, 2>;

WandPlace place_of(const DevicePose& device, const RoomPlace& room);

}  // namespace tetwarp::view

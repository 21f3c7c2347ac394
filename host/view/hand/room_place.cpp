/// @file room_place.cpp
/// Maps between device, room and world.
#include "host/view/hand/room_place.hpp"

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
Point3 along_axes(const std::array<Point3, 3>& axes, const Point3& x) {
  return plus(plus(times(x[0], axes[0]), times(x[1], axes[1])), times(x[2], axes[2]));
}
}  // namespace

std::array<Point3, 3> columns_of(const std::array<double, 4>& rotation) {
  const auto& [w, x, y, z] = rotation;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)},
           {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)},
           {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)}}};
}

Point3 RoomPlace::world_of(const Point3& x) const {
  return plus(origin, along_axes(axes, minus(x, observer)));
}

Point3 WandPlace::world_of(const Point3& x) const {
  return plus(origin, along_axes(axes, x));
}

Point3 WandPlace::local_of(const Point3& world) const {
  const Point3 arm = minus(world, origin);
  Point3 local{};
  for (std::size_t a = 0; a < 3; ++a) local[a] = dot(arm, axes[a]) / dot(axes[a], axes[a]);
  return local;
}

EyeRay WandPlace::ray() const {
  return {origin, times(-1, axes[2])};
}

WandPlace place_of(const DevicePose& device, const RoomPlace& room) {
  WandPlace wand{room.world_of(device.position), {}};
  const std::array<Point3, 3> columns = columns_of(device.rotation);
  for (std::size_t a = 0; a < 3; ++a) wand.axes[a] = along_axes(room.axes, columns[a]);
  return wand;
}

}  // namespace tetwarp::view

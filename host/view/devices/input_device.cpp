/// @file input_device.cpp
/// Moves and turns in the axes of a camera.
#include "host/view/devices/input_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/base/point3.hpp"

namespace tetwarp::view {
namespace {
constexpr double most_way = 0.5;                    // distances of eye and target a second
constexpr double most_turn = std::numbers::pi / 2;  // [1/s]
constexpr double rest_share = 0.15;                 // of a stick, within which it rests

/// Right, up and back.
std::array<Point3, 3> axes_of(const Camera& camera) {
  const Point3 back = unit(minus(camera.eye, camera.target));
  const Point3 right = unit(cross(camera.up, back));
  return {right, cross(back, right), back};
}

Point3 along(const std::array<Point3, 3>& axes, const Point3& x) {
  return plus(plus(times(x[0], axes[0]), times(x[1], axes[1])), times(x[2], axes[2]));
}

/// Rodrigues' formula.
Point3 turned(const Point3& x, const Point3& axis, double angle) {
  const Point3 part = times(dot(axis, x) * (1 - std::cos(angle)), axis);
  return plus(plus(times(std::cos(angle), x), times(std::sin(angle), cross(axis, x))), part);
}
}  // namespace

bool is_in_world(const Point3& x) {
  return std::ranges::all_of(x, [](double part) { return std::abs(part) < largest_world; });
}

double beyond_rest(double value) {
  const double size = std::max(std::abs(value) - rest_share, 0.0) / (1 - rest_share);
  return std::copysign(std::min(size, 1.0), value);
}

std::optional<std::array<double, 4>> unit_rotation(const std::array<double, 4>& rotation) {
  const auto& [w, x, y, z] = rotation;
  const double size = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(size > 0 && std::isfinite(size))) return std::nullopt;
  return std::array{w / size, x / size, y / size, z / size};
}

std::optional<DevicePose> device_pose(const Point3& position,
                                      const std::array<double, 4>& rotation) {
  const auto unit = unit_rotation(rotation);
  if (!unit || !is_in_world(position)) return std::nullopt;
  return DevicePose{position, *unit};
}

Point3 carried_way(const Camera& camera, const DeviceSpan& by) {
  const double distance = norm(minus(camera.eye, camera.target));
  return times(most_way * distance * by.seconds, along(axes_of(camera), by.state.move));
}

Camera moved_camera(const Camera& camera, const DeviceSpan& by) {
  Camera moved = camera;
  const Point3 way = carried_way(camera, by), turn = along(axes_of(camera), by.state.turn);
  moved.target = plus(camera.target, way);
  Point3 arm = minus(camera.eye, camera.target);
  const double size = norm(turn);
  if (size > 0) {
    // The camera turns against the scene, which turns as the hand does.
    const Point3 axis = times(1 / size, turn);
    const double angle = -most_turn * size * by.seconds;
    arm = turned(arm, axis, angle);
    moved.up = turned(camera.up, axis, angle);
  }
  moved.eye = plus(moved.target, arm);
  return moved;
}

}  // namespace tetwarp::view

/// @file camera_keys.cpp
/// Keys as pushes of a device, and the six views along the axes.
#include "host/view/camera_keys.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "host/base/point3.hpp"
#include "host/view/devices/input_device.hpp"

namespace tetwarp::view {
namespace {
constexpr double turn_seconds = 5.0 / 90;  // of a device, for 5 degrees
constexpr double move_seconds = 0.1;       // for a twentieth of the distance
constexpr double zoom = 1.1;

struct ArrowKey {
  const char* name;
  Point3 turn, move;
};
constexpr ArrowKey arrows[] = {{"Left", {0, -1, 0}, {1, 0, 0}},
                               {"Right", {0, 1, 0}, {-1, 0, 0}},
                               {"Up", {-1, 0, 0}, {0, -1, 0}},
                               {"Down", {1, 0, 0}, {0, 1, 0}}};

/// From the target to the eye, and upwards.
struct StandardView {
  Point3 back, up;
};
// Each is followed by the one from the opposite side.
constexpr std::array<StandardView, 6> views{{{{0, 1, 0}, {0, 0, 1}},
                                             {{0, -1, 0}, {0, 0, 1}},
                                             {{-1, 0, 0}, {0, 0, 1}},
                                             {{1, 0, 0}, {0, 0, 1}},
                                             {{0, 0, 1}, {0, 1, 0}},
                                             {{0, 0, -1}, {0, 1, 0}}}};
// Names of the keypad with and without Num Lock, and the first view of their pair.
struct ViewKey {
  const char *locked, *plain;
  std::size_t view;
};
constexpr ViewKey view_keys[] = {
    {"KP_1", "KP_End", 0}, {"KP_3", "KP_Next", 2}, {"KP_7", "KP_Home", 4}};

Camera seen_from(const StandardView& view, Camera camera) {
  const double distance = norm(minus(camera.eye, camera.target));
  camera.eye = plus(camera.target, times(distance, view.back));
  camera.up = view.up;
  return camera;
}

Camera zoomed(Camera camera, double by) {
  camera.eye = plus(camera.target, times(1 / by, minus(camera.eye, camera.target)));
  return camera;
}
}  // namespace

std::optional<Camera> camera_after(const PressedKey& key, const Camera& now, const Camera& start) {
  const std::string& name = key.name;
  if (key.has_control) return std::nullopt;
  if (name == "r") return start;
  if (name == "plus" || name == "KP_Add") return zoomed(now, zoom);
  if (name == "minus" || name == "KP_Subtract") return zoomed(now, 1 / zoom);
  for (const ArrowKey& arrow : arrows) {
    if (name != arrow.name) continue;
    if (key.has_shift) return moved_camera(now, {{.move = arrow.move}, move_seconds});
    return moved_camera(now, {{.turn = arrow.turn}, turn_seconds});
  }
  for (const ViewKey& of : view_keys) {
    if (name == of.locked || name == of.plain) {
      return seen_from(views[of.view + (key.has_shift ? 1 : 0)], now);
    }
  }
  if (name != "KP_0" && name != "KP_Insert") return std::nullopt;
  const Point3 back = minus(now.eye, now.target);
  return seen_from(*std::ranges::max_element(
                       views, {}, [&](const StandardView& view) { return dot(view.back, back); }),
                   now);
}

}  // namespace tetwarp::view

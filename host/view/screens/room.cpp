/// @file room.cpp
/// Checks of rooms, heads and the room's place in the world.
#include "host/view/screens/room.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "host/view/devices/tracked_names.hpp"
#include "host/view/screens/off_axis.hpp"

namespace tetwarp::view {
namespace {
constexpr double square_tolerance = 1e-3;  // of the cosine between the edges of a screen

void check_screen(const Screen& screen, const Point3& observer) {
  const auto refuse = [&](const std::string& problem) {
    throw std::invalid_argument("screen " + screen.name + ": " + problem);
  };
  for (const Point3& corner : {screen.lower_left, screen.lower_right, screen.upper_right}) {
    if (!is_in_world(corner)) refuse("a corner is not within 1e9 m of the origin");
  }
  const Point3 across = minus(screen.lower_right, screen.lower_left);
  const Point3 up = minus(screen.upper_right, screen.lower_right);
  if (!(norm(across) > 0 && norm(up) > 0)) refuse("two of its corners coincide");
  if (std::abs(dot(unit(across), unit(up))) > square_tolerance) {
    refuse("the lower and the right edge are not at a right angle");
  }
  if (!off_axis_view(screen, observer)) {
    refuse(
        "the observer is not in front of it; its corners are lower left, lower right and upper "
        "right as the observer sees them");
  }
  for (std::size_t n = 0; n < 4; ++n) {
    const bool is_place = n < 2;
    const std::int32_t low = is_place ? -farthest_window : 0;
    const std::int32_t high = is_place ? farthest_window : largest_window;
    if (screen.window[n] >= low && screen.window[n] <= high) continue;
    refuse(std::string("window (Geometry in a .pvx file): ") +
           (is_place ? "left and top are " : "width and height are ") + std::to_string(low) +
           " to " + std::to_string(high) + " pixels");
  }
}
}  // namespace

void check_room(Room& room) {
  if (room.screens.empty()) throw std::invalid_argument("screens: there are none");
  if (!is_in_world(room.observer)) {
    throw std::invalid_argument("observer: is not within 1e9 m of the origin");
  }
  if (!(room.eye_separation >= 0 && room.eye_separation < 1)) {
    throw std::invalid_argument("eye_separation: is 0 to 1 m");
  }
  if (!(room.wait > 0 && room.wait <= 60)) {
    throw std::invalid_argument("wait: is above 0 and at most 60 s");
  }
  if (!room.tracker.empty()) tracked_names(room.tracker);
  std::set<std::string> names;
  for (const Screen& screen : room.screens) {
    if (screen.name.empty()) throw std::invalid_argument("screens: each needs a name");
    if (!names.insert(screen.name).second) {
      throw std::invalid_argument("screen " + screen.name + ": another one has the same name");
    }
    check_screen(screen, room.observer);
  }
  if (room.focus == 0) room.focus = off_axis_view(room.screens[0], room.observer)->distance;
  if (!(room.focus > 0 && std::isfinite(room.focus))) {
    throw std::invalid_argument("focus: is above 0");
  }
}

HeadPose head_at(const std::vector<HeadPoint>& path, double time) {
  const auto next = std::ranges::find_if(path, [&](const HeadPoint& p) { return p.time > time; });
  if (next == path.begin()) return path.front().pose;
  if (next == path.end()) return path.back().pose;
  const HeadPoint& before = *(next - 1);
  const double share = (time - before.time) / (next->time - before.time);
  const HeadPose &a = before.pose, &b = next->pose;
  HeadPose head{plus(times(1 - share, a.position), times(share, b.position)), {}};
  double same = 0, size = 0;
  for (std::size_t n = 0; n < 4; ++n) same += a.rotation[n] * b.rotation[n];
  for (std::size_t n = 0; n < 4; ++n) {
    head.rotation[n] = (1 - share) * a.rotation[n] + (same < 0 ? -share : share) * b.rotation[n];
    size += head.rotation[n] * head.rotation[n];
  }
  for (double& part : head.rotation) part /= std::sqrt(size);
  return head;
}

std::array<Point3, 2> eyes_of(const HeadPose& head, double eye_separation) {
  const Point3 half = times(eye_separation / 2, columns_of(head.rotation)[0]);
  return {minus(head.position, half), plus(head.position, half)};
}

RoomPlace place_of_camera(const Room& room, const Camera& camera) {
  const Point3 arm = minus(camera.eye, camera.target), back = unit(arm);
  const Point3 right = unit(cross(camera.up, back));
  const double meter = norm(arm) / room.focus;
  if (!(meter > 0 && norm(right) > 0)) throw std::invalid_argument("the camera has no direction");
  return {room.observer,
          camera.eye,
          {times(meter, right), times(meter, cross(back, right)), times(meter, back)}};
}

}  // namespace tetwarp::view

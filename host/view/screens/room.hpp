/// @file room.hpp
/// Room: screens around an observer, in coordinates of the room: x to the right, y up, z back [m].
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <tetwarp/make.hpp>
#include <tetwarp/volume.hpp>

#include "host/view/hand/room_place.hpp"

namespace tetwarp::view {

/// Limits of rooms, of their files and of messages alike.
inline constexpr std::int32_t farthest_window = 65535;  ///< left and top, either way [pixel]
inline constexpr std::int32_t largest_window = 16384;   ///< width and height [pixel]

/// How a screen shows two eyes, or which one.
enum class Stereo : std::uint8_t { none, side_by_side, anaglyph, quad_buffer, left, right };

/// A flat rectangle.
struct Screen {
  std::string name;
  Point3 lower_left{}, lower_right{}, upper_right{};  ///< corners as the observer sees them
  Stereo stereo = Stereo::none;
  std::array<std::int32_t, 4> window{0, 0, 0, 0};  ///< left, top, width, height [pixel]; 0, 0: 640
  bool is_fullscreen = false;
  bool has_border = false;
  std::string display;  ///< of X11; empty: that of the process
  std::string host;     ///< that shows it; empty: the host of the master, which starts it
};

/// Where the observer's head is: the middle between the eyes, and a rotation.
struct HeadPose {
  Point3 position{};
  std::array<double, 4> rotation{1, 0, 0, 0};  ///< unit quaternion w x y z

  bool operator==(const HeadPose&) const = default;
};

/// A head pose at a time, for a motion that is known beforehand.
struct HeadPoint {
  double time = 0;  ///< since the master began [s]
  HeadPose pose;
};

struct Room {
  std::string address = "tcp://127.0.0.1:5611";  ///< that the master listens at
  Point3 observer{};                             ///< head where nothing tracks it
  double eye_separation = 0.065;                 ///< [m]
  double focus = 0;   ///< distance at which the camera's target is shown [m]
  double wait = 0.1;  ///< longest wait for the slowest screen before the others swap [s]
  std::vector<Screen> screens;
  std::vector<HeadPoint> head_path;  ///< of a simulated tracker; empty: none
  std::string tracker;               ///< of the head, see open_tracked_device(); empty: none
  std::vector<std::string> notes;    ///< keys of its file that have no effect, a line for each
};

/// Checks numbers and names and computes `focus` where it is 0: the distance of the first screen.
/// @throws std::invalid_argument  naming the screen and the problem
void check_room(Room& room);

/// The head of the simulated tracker.
HeadPose head_at(const std::vector<HeadPoint>& path, double time);

/// Left and right eye in the room.
std::array<Point3, 2> eyes_of(const HeadPose& head, double eye_separation);

/// The room whose observer looks ahead as a camera does, with the camera's target at the focus.
/// @throws std::invalid_argument  the camera's eye and target coincide, or `up` is along its view
RoomPlace place_of_camera(const Room& room, const Camera& camera);

}  // namespace tetwarp::view

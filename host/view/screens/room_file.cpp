/// @file room_file.cpp
/// Keys of rooms.
#include "host/view/screens/room_file.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {

template <>
std::span<const EnumName<view::Stereo>> names_of<view::Stereo>() {
  static constexpr EnumName<view::Stereo> names[] = {
      {view::Stereo::none, "none"},         {view::Stereo::side_by_side, "side_by_side"},
      {view::Stereo::anaglyph, "anaglyph"}, {view::Stereo::quad_buffer, "quad_buffer"},
      {view::Stereo::left, "left"},         {view::Stereo::right, "right"}};
  return names;
}

namespace view {
namespace {
constexpr const char* head_text = "[t, x, y, z] or [t, x, y, z, qw, qx, qy, qz] with t rising";

void read_text_of(SceneObject& object, const char* key, std::string& into) {
  if (const auto value = object.find(key)) into = value->text();
}

HeadPoint read_head(const SceneValue& value) {
  const std::vector<SceneValue> row = value.items(head_text);
  if (row.size() != 4 && row.size() != 8) value.fail_type(head_text);
  HeadPoint point;
  point.time = row[0].number();
  point.pose.position = {row[1].number(), row[2].number(), row[3].number()};
  if (row.size() == 4) return point;
  double size = 0;
  for (std::size_t n = 0; n < 4; ++n) {
    point.pose.rotation[n] = row[4 + n].number();
    size += point.pose.rotation[n] * point.pose.rotation[n];
  }
  if (!(size > 0)) value.fail("has a quaternion of length 0");
  for (double& part : point.pose.rotation) part /= std::sqrt(size);
  return point;
}

Screen read_screen(const SceneValue& value, Stereo stereo) {
  SceneObject object(value);
  Screen screen;
  screen.stereo = stereo;
  screen.name = object.get("name", "the name of the screen").text();
  screen.lower_left = object.get("lower_left", "a corner [x, y, z]").point();
  screen.lower_right = object.get("lower_right", "a corner [x, y, z]").point();
  screen.upper_right = object.get("upper_right", "a corner [x, y, z]").point();
  object.read("stereo", screen.stereo);
  if (const auto window = object.find("window")) {
    const std::vector<double> numbers = window->numbers(4);
    for (std::size_t n = 0; n < 4; ++n) {
      if (!(std::abs(numbers[n]) <= farthest_window))
        window->fail("is [left, top, width, height] in pixels");
      screen.window[n] = static_cast<std::int32_t>(numbers[n]);
    }
  }
  object.read("fullscreen", screen.is_fullscreen);
  object.read("border", screen.has_border);
  read_text_of(object, "display", screen.display);
  read_text_of(object, "host", screen.host);
  object.finish();
  return screen;
}
}  // namespace

Room parse_room(const std::string& text, const std::string& name) {
  const SceneJson json = parse_json(text, name);
  SceneObject object(SceneValue(json, name, ""));
  if (object.get("tetwarp_room", "the number 1 of the format").whole(1) != 1) {
    object.fail("tetwarp_room: is a later format than this program reads");
  }
  Room room;
  Stereo stereo = Stereo::none;
  read_text_of(object, "address", room.address);
  read_text_of(object, "tracker", room.tracker);
  object.read("observer", room.observer);
  object.read("eye_separation", room.eye_separation);
  object.read("focus", room.focus);
  object.read("wait", room.wait);
  object.read("stereo", stereo);
  for (const SceneValue& value : object.get("screens", "a list of screens").items()) {
    room.screens.push_back(read_screen(value, stereo));
  }
  if (const auto path = object.find("head_path")) {
    for (const SceneValue& value : path->items()) {
      room.head_path.push_back(read_head(value));
      const std::size_t count = room.head_path.size();
      if (count > 1 && !(room.head_path[count - 2].time < room.head_path.back().time)) {
        value.fail_type(head_text);
      }
    }
  }
  object.finish();
  try {
    check_room(room);
  } catch (const std::invalid_argument& error) {
    throw IoError(name, "", error.what());
  }
  return room;
}

}  // namespace view
}  // namespace tetwarp

/// @file scene_motion.cpp
/// Paths, hinges, waves and selections of scene files.

#include "io/scene/scene_motion.hpp"

namespace tetwarp {
namespace {
const char* const path_text =
    "a list of points [t, x, y, z] or [t, x, y, z, ax, ay, az]; [t, null] lets go";

/// A point [t, null] or [t, null, null, null].
bool lets_go(const std::vector<SceneValue>& row) {
  if (row.size() != 2 && row.size() != 4) return false;
  for (std::size_t n = 1; n < row.size(); ++n) {
    if (!row[n].is_null()) return false;
  }
  return true;
}

PathPoint read_point(const SceneValue& value) {
  const std::vector<SceneValue> row = value.items("a point [t, x, y, z] of a path");
  if (row.size() != 4 && row.size() != 7 && !lets_go(row)) value.fail_type(path_text);
  PathPoint point;
  point.time = row[0].number();
  if (lets_go(row)) return point;
  point.displacement = {row[1].number(), row[2].number(), row[3].number()};
  if (row.size() == 7) point.axis_angle = {row[4].number(), row[5].number(), row[6].number()};
  return point;
}

Hinge read_hinge(const SceneValue& value) {
  SceneObject object(value);
  Hinge hinge;
  hinge.point = object.get("point", "a point [x, y, z] of the axis").point();
  hinge.axis = object.get("axis", "the direction [x, y, z] of the axis").point();
  for (const SceneValue& row : object.get("angle", "[[time, angle], ...]").items()) {
    hinge.angle.push_back(row.array<2>());
  }
  object.finish();
  return hinge;
}

Wave read_wave(const SceneValue& value) {
  SceneObject object(value);
  Wave wave;
  const auto read_axis = [&](const char* key, int& axis) {
    if (const auto found = object.find(key)) {
      const std::int64_t number = found->whole(0);
      if (number > 2) found->fail("is " + std::to_string(number) + ", expected 0, 1 or 2");
      axis = static_cast<int>(number);
    }
  };
  read_axis("axis", wave.axis);
  read_axis("lateral", wave.lateral);
  object.read("frequency", wave.frequency);
  object.read("wavelength", wave.wavelength);
  object.read("phase", wave.phase);
  wave.envelope = object.get("envelope", "[a0, a1, a2]").array<3>();
  object.finish();
  return wave;
}

SelectionPart read_part(const SceneValue& value) {
  if (value.is_text()) {
    if (value.text() != "all") value.fail("is no selection, expected \"all\" or an object");
    return AllSelection{};
  }
  SceneObject object(value, "a selection: \"all\", an object or a list of them");
  std::vector<SelectionPart> parts;
  if (const auto box = object.find("box")) {
    const std::vector<SceneValue> corners = box->items("two corners [[x, y, z], [x, y, z]]");
    if (corners.size() != 2) box->fail_type("two corners [[x, y, z], [x, y, z]]");
    parts.push_back(BoxSelection{corners[0].point(), corners[1].point()});
  }
  if (const auto sphere = object.find("sphere")) {
    const auto numbers = sphere->array<4>();
    parts.push_back(SphereSelection{{numbers[0], numbers[1], numbers[2]}, numbers[3]});
  }
  if (const auto half = object.find("half_space")) {
    const auto numbers = half->array<4>();
    parts.push_back(HalfSpaceSelection{{numbers[0], numbers[1], numbers[2]}, numbers[3]});
  }
  if (const auto label = object.find("label")) parts.push_back(LabelSelection{label->number()});
  if (const auto nodes = object.find("nodes")) {
    NodeSelection selection;
    for (const SceneValue& node : nodes->items("a list of nodes")) {
      selection.nodes.push_back(node.whole(0));
    }
    parts.push_back(std::move(selection));
  }
  object.finish();
  if (parts.size() != 1) {
    value.fail("expected exactly one of box, sphere, half_space, label and nodes");
  }
  return std::move(parts.front());
}
}  // namespace

Selection read_selection(const SceneValue& value) {
  if (!value.is_list()) return {read_part(value)};
  Selection selection;
  for (const SceneValue& part : value.items()) selection.push_back(read_part(part));
  if (selection.empty()) value.fail("is empty, expected a selection or more");
  return selection;
}

Path read_path(const SceneValue& value) {
  Path path;
  for (const SceneValue& point : value.items(path_text)) path.push_back(read_point(point));
  if (path.empty()) value.fail_type(path_text);
  return path;
}

void read_motion(SceneObject& object, Motion& into) {
  int count = 0;
  if (const auto path = object.find("path")) {
    into = read_path(*path);
    ++count;
  }
  if (const auto hinge = object.find("hinge")) {
    into = read_hinge(*hinge);
    ++count;
  }
  if (const auto wave = object.find("wave")) {
    into = read_wave(*wave);
    ++count;
  }
  if (count > 1) object.fail("has several motions, expected one of path, hinge and wave");
}

}  // namespace tetwarp

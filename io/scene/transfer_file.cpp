/// @file transfer_file.cpp
/// Reads transfer functions by the keys of their JSON.
#include <algorithm>
#include <tetwarp/transfer_file.hpp>
#include <vector>

#include "io/files/text_file.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp {
namespace {
double share_of(const SceneValue& value) {
  const double number = value.number();
  if (!(number >= 0 && number <= 1)) value.fail("expected a number from 0 to 1");
  return number;
}
}  // namespace

TransferFunction read_transfer_function(const std::string& path, double length) {
  const SceneJson json = parse_json(read_text(path), path);
  SceneObject object(SceneValue(json, path, ""));
  TransferFunction function{{}, length};
  if (const auto value = object.find("length")) {
    function.unit_length = value->number();
    if (!(function.unit_length > 0)) value->fail("expected a length above 0");
  }
  const SceneValue points = object.get("points", "a list of {\"value\", \"color\", \"opacity\"}");
  for (const SceneValue& item : points.items()) {
    SceneObject keys(item);
    ColorPoint point;
    const SceneValue value = keys.get("value", "a number");
    point.value = value.number();
    const SceneValue color = keys.get("color", "[red, green, blue] from 0 to 1");
    point.color = color.array<3>();
    if (std::ranges::min(point.color) < 0 || std::ranges::max(point.color) > 1) {
      color.fail("expected [red, green, blue] from 0 to 1");
    }
    point.opacity = share_of(keys.get("opacity", "a number from 0 to 1"));
    keys.finish();
    if (!function.points.empty() && point.value < function.points.back().value) {
      value.fail("is below the value before; sort the points by value");
    }
    function.points.push_back(point);
  }
  if (function.points.empty()) points.fail("is empty, expected one or more points");
  object.finish();
  return function;
}

}  // namespace tetwarp

/// @file markup_points.cpp
/// Reads positions of control points in the axes of their markup.
#include "io/points/markup_points.hpp"

#include <tetwarp/error.hpp>

#include "io/files/finished_file.hpp"
#include "io/files/text_file.hpp"

namespace tetwarp {
namespace {
using Json = nlohmann::ordered_json;

Json parsed(const std::string& path) {
  const std::string text = read_text(path);
  try {
    return Json::parse(text);
  } catch (const Json::exception& error) {
    throw IoError(path, "", std::string("is no JSON: ") + error.what());
  }
}

/// Calls visit(point, markup, name of the point) for all control points that have a position.
template <class Root, class Visit>
void visit_points(Root& root, const Visit& visit) {
  std::size_t m = 0;
  for (auto& markup : root["markups"]) {
    const std::string name = "markups[" + std::to_string(m++) + "]";
    if (!markup.is_object() || !markup.contains("controlPoints")) continue;
    std::size_t p = 0;
    for (auto& point : markup["controlPoints"]) {
      const std::string place = name + ".controlPoints[" + std::to_string(p++) + "]";
      const bool is_undefined = point.is_object() && point.contains("positionStatus") &&
                                point["positionStatus"] == "undefined";
      if (!is_undefined) visit(point, markup, place);
    }
  }
}
}  // namespace

MarkupPoints::MarkupPoints(const std::string& path, Axes axes)
    : path_(path), root_(parsed(path)), axes_(axes) {
  if (!root_.is_object() || !root_.contains("markups") || !root_["markups"].is_array()) {
    throw IoError(path, "", "holds no markups of 3D Slicer");
  }
  visit_points(root_, [&](const Json& point, const Json& markup, const std::string& place) {
    const Axes own = axes_of(markup, place);
    names_axes_ = names_axes_ && markup.contains("coordinateSystem");
    const bool has_position = point.is_object() && point.contains("position") &&
                              point["position"].is_array() && point["position"].size() == 3;
    Point3 x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!has_position || !point["position"][axis].is_number()) {
        throw IoError(path, place, "expected a position of three numbers");
      }
      x[axis] = point["position"][axis].get<double>();
    }
    points_.push_back(between(own, x));
  });
  if (points_.empty()) throw IoError(path, "", "holds no point");
}

Axes MarkupPoints::axes_of(const Json& markup, const std::string& place) const {
  if (!markup.contains("coordinateSystem")) return axes_;
  const Json& system = markup["coordinateSystem"];
  if (system == "LPS" || system == "1" || system == 1) return Axes::lps;
  if (system == "RAS" || system == "0" || system == 0) return Axes::ras;
  throw IoError(path_, place, "has neither the coordinateSystem RAS nor LPS");
}

std::string MarkupPoints::write(const std::string& path, const PlacedPoints& placed) const {
  Json copy = root_;
  std::size_t p = 0;
  visit_points(copy, [&](Json& point, const Json& markup, const std::string& place) {
    if (placed.inside[p] != 0) {
      const Point3 x = between(axes_of(markup, place), placed.points[p]);
      point["position"] = {x[0], x[1], x[2]};
    }
    point["inside"] = placed.inside[p];
    ++p;
  });
  write_finished_file(path, copy.dump(4, ' ', false, Json::error_handler_t::replace) + "\n");
  return {};
}

}  // namespace tetwarp

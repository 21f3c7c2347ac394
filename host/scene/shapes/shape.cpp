/// @file shape.cpp
/// Levels, boxes and volumes of each kind of shape.
#include "host/scene/shapes/shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

namespace tetwarp {
namespace {
using std::numbers::pi;

template <class... Calls>
struct Overloaded : Calls... {
  using Calls::operator()...;
};
template <class... Calls>
Overloaded(Calls...) -> Overloaded<Calls...>;

double box_level(const Point3& half, const Point3& x) {
  return std::max({std::abs(x[0]) - half[0], std::abs(x[1]) - half[1], std::abs(x[2]) - half[2]});
}
/// Level of an arc: distance from its center line minus the radius of the tube.
class ArcLevel {
 public:
  explicit ArcLevel(const ArcShape& arc)
      : arc_(arc),
        half_(0.5 * (arc.angles[1] - arc.angles[0])),
        cos_middle_(std::cos(0.5 * (arc.angles[0] + arc.angles[1]))),
        sin_middle_(std::sin(0.5 * (arc.angles[0] + arc.angles[1]))),
        end_{arc.radius * std::cos(half_), arc.radius * std::sin(half_)} {}

  double operator()(const Point3& x) const {
    // In the frame whose x axis goes through the middle of the arc, which is symmetric about it.
    const double along = cos_middle_ * x[0] + sin_middle_ * x[1];
    const double across = std::abs(cos_middle_ * x[1] - sin_middle_ * x[0]);
    if (std::atan2(across, along) <= half_) {
      const double beyond = std::sqrt(along * along + across * across) - arc_.radius;
      return std::sqrt(beyond * beyond + x[2] * x[2]) - arc_.tube;
    }
    const double a = along - end_[0], b = across - end_[1];
    return std::sqrt(a * a + b * b + x[2] * x[2]) - arc_.tube;
  }

 private:
  ArcShape arc_;
  double half_, cos_middle_, sin_middle_;
  std::array<double, 2> end_;
};

Bounds box_bounds(const Point3& half) {
  return {times(-1.0, half), half};
}
Bounds arc_bounds(const ArcShape& arc) {
  Bounds bounds;
  const auto include = [&](double angle) {
    const Point3 center{arc.radius * std::cos(angle), arc.radius * std::sin(angle), 0};
    const Point3 reach{arc.tube, arc.tube, arc.tube};
    bounds.include(minus(center, reach));
    bounds.include(plus(center, reach));
  };
  include(arc.angles[0]);
  include(arc.angles[1]);
  for (double quarter = std::ceil(arc.angles[0] / (pi / 2)); quarter * (pi / 2) < arc.angles[1];
       ++quarter) {
    include(quarter * (pi / 2));
  }
  return bounds;
}
}  // namespace

double rise_of(const BentStripShape& strip, double x) {
  const double s = 2 * x / strip.width;
  return strip.sag * (1 - s * s);
}

Bounds straight_bounds(const BentStripShape& strip) {
  return box_bounds({strip.width / 2, strip.depth / 2, strip.height / 2});
}

Bounds bounds_of(const Shape& shape) {
  return std::visit(Overloaded{[](const BoxShape& s) { return box_bounds(s.half); },
                               [](const EllipsoidShape& s) { return box_bounds(s.radii); },
                               [](const CapsuleShape& s) {
                                 return box_bounds({s.radius, s.radius, s.length / 2 + s.radius});
                               },
                               [](const CylinderShape& s) {
                                 return box_bounds({s.radius, s.radius, s.length / 2});
                               },
                               [](const TorusShape& s) {
                                 return box_bounds({s.radius + s.tube, s.radius + s.tube, s.tube});
                               },
                               [](const ArcShape& s) { return arc_bounds(s); },
                               [](const BentStripShape& s) {
                                 Bounds bounds = straight_bounds(s);
                                 bounds.low[2] += std::min(s.sag, 0.0);
                                 bounds.high[2] += std::max(s.sag, 0.0);
                                 return bounds;
                               },
                               [](const PlateShape& s) { return box_bounds(times(0.5, s.size)); }},
                    shape);
}

double volume_of(const Shape& shape) {
  return std::visit(
      Overloaded{
          [](const BoxShape& s) { return 8 * s.half[0] * s.half[1] * s.half[2]; },
          [](const EllipsoidShape& s) { return 4 * pi / 3 * s.radii[0] * s.radii[1] * s.radii[2]; },
          [](const CapsuleShape& s) {
            return pi * s.radius * s.radius * (s.length + 4 * s.radius / 3);
          },
          [](const CylinderShape& s) { return pi * s.radius * s.radius * s.length; },
          [](const TorusShape& s) { return 2 * pi * pi * s.radius * s.tube * s.tube; },
          [](const ArcShape& s) {
            return pi * s.tube * s.tube * (s.radius * (s.angles[1] - s.angles[0]) + 4 * s.tube / 3);
          },
          [](const BentStripShape& s) { return s.width * s.height * s.depth; },
          [](const PlateShape& s) { return s.size[0] * s.size[1] * s.size[2]; }},
      shape);
}

std::function<double(const Point3&)> make_level(const Shape& shape) {
  using Level = std::function<double(const Point3&)>;
  const auto length = [](double a, double b) { return std::sqrt(a * a + b * b); };
  const auto box = [](const Point3& half) -> Level {
    return [half](const Point3& x) { return box_level(half, x); };
  };
  return std::visit(
      Overloaded{
          [&](const BoxShape& s) { return box(s.half); },
          [&](const EllipsoidShape& s) -> Level {
            return [=](const Point3& x) {
              return length(length(x[0] / s.radii[0], x[1] / s.radii[1]), x[2] / s.radii[2]) - 1;
            };
          },
          [&](const CapsuleShape& s) -> Level {
            return [=](const Point3& x) {
              const double beyond = std::max(std::abs(x[2]) - s.length / 2, 0.0);
              return length(length(x[0], x[1]), beyond) - s.radius;
            };
          },
          [&](const CylinderShape& s) -> Level {
            return [=](const Point3& x) {
              return std::max(length(x[0], x[1]) - s.radius, std::abs(x[2]) - s.length / 2);
            };
          },
          [&](const TorusShape& s) -> Level {
            return [=](const Point3& x) {
              return length(length(x[0], x[1]) - s.radius, x[2]) - s.tube;
            };
          },
          [&](const ArcShape& s) -> Level { return ArcLevel(s); },
          [&](const BentStripShape& s) -> Level {
            return [=](const Point3& x) {
              const double inside = std::clamp(x[0], -s.width / 2, s.width / 2);
              return box_level({s.width / 2, s.depth / 2, s.height / 2},
                               {x[0], x[1], x[2] - rise_of(s, inside)});
            };
          },
          [&](const PlateShape& s) { return box(times(0.5, s.size)); }},
      shape);
}

double level_slope(const Shape& shape) {
  if (const auto* ellipsoid = std::get_if<EllipsoidShape>(&shape)) {
    return 1 / *std::min_element(ellipsoid->radii.begin(), ellipsoid->radii.end());
  }
  if (const auto* strip = std::get_if<BentStripShape>(&shape)) {
    return std::hypot(1.0, 4 * strip->sag / strip->width);
  }
  return 1;
}

double feature_length(const Shape& shape) {
  return std::visit(
      Overloaded{
          [](const BoxShape& s) { return *std::min_element(s.half.begin(), s.half.end()); },
          [](const EllipsoidShape& s) { return *std::min_element(s.radii.begin(), s.radii.end()); },
          [](const CapsuleShape& s) { return s.radius; },
          [](const CylinderShape& s) { return std::min(s.radius, s.length / 2); },
          [](const TorusShape& s) { return s.tube; }, [](const ArcShape& s) { return s.tube; },
          [](const BentStripShape& s) {
            return std::min({s.width, s.depth, s.height}) / 2;
          },
          [](const PlateShape& s) { return *std::min_element(s.size.begin(), s.size.end()) / 2; }},
      shape);
}

}  // namespace tetwarp

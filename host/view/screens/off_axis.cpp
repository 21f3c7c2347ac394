/// @file off_axis.cpp
/// With x and y the unit edges of the screen, n = x cross y, and e the eye from the lower left
/// corner: distance e . n, left edge -e . x, bottom edge -e . y.
#include "host/view/screens/off_axis.hpp"

#include "host/base/point3.hpp"

namespace tetwarp::view {

std::optional<OffAxisView> off_axis_view(const Screen& screen, const Point3& eye) {
  const Point3 across = minus(screen.lower_right, screen.lower_left);
  const Point3 upwards = minus(screen.upper_right, screen.lower_right);
  const Point3 x = unit(across), n = unit(cross(x, upwards)), y = cross(n, x);
  const Point3 arm = minus(eye, screen.lower_left);
  const double distance = dot(arm, n);
  if (!(distance > 1e-6 * norm(across))) return std::nullopt;
  const double left = -dot(arm, x) / distance, bottom = -dot(arm, y) / distance;
  return OffAxisView{
      eye,
      minus(eye, times(distance, n)),
      y,
      distance,
      {left, left + norm(across) / distance, bottom, bottom + norm(upwards) / distance}};
}

std::array<double, 16> projection_of(const OffAxisView& view, double nearest, double farthest) {
  const auto& [left, right, bottom, top] = view.tangents;
  const double depth = farthest - nearest;
  return {2 / (right - left),
          0,
          (right + left) / (right - left),
          0,
          0,
          2 / (top - bottom),
          (top + bottom) / (top - bottom),
          0,
          0,
          0,
          -(farthest + nearest) / depth,
          -2 * farthest * nearest / depth,
          0,
          0,
          -1,
          0};
}

}  // namespace tetwarp::view

/// @file patch_frame.hpp
/// Coordinates of contacts in the plane of a patch.
#pragma once
#include <array>
#include <cmath>

#include <tetwarp/contact_tracker.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// Two axes perpendicular to a normal.
struct PatchFrame {
  PatchFrame(const Point3& normal, const Point3& of_origin) : origin(of_origin) {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (std::abs(normal[i]) < std::abs(normal[axis])) axis = i;
    }
    Point3 along{0, 0, 0};
    along[axis] = 1;
    first = unit(cross(along, normal));
    second = cross(normal, first);
  }
  std::array<double, 2> place(const Point3& x) const {
    const Point3 apart = minus(x, origin);
    return {dot(apart, first), dot(apart, second)};
  }
  Point3 across(double x, double y) const { return plus(times(x, first), times(y, second)); }

  Point3 origin, first, second;
};

inline Point3 middle_of(const ReportedContact& contact) {
  return times(0.5, plus(contact.point_a_world, contact.point_b_world));
}
inline double gap_of(const ReportedContact& contact) {
  return dot(contact.normal, minus(contact.point_a_world, contact.point_b_world));
}

/// The eigenvalues of a symmetric 2x2 matrix, the larger first, and the angle of the first
/// eigenvector.
struct Axes2 {
  double large = 0, small = 0, angle = 0;
};
inline Axes2 axes_of(double xx, double xy, double yy) {
  const double mean = (xx + yy) / 2, half = (xx - yy) / 2, radius = std::hypot(half, xy);
  return {mean + radius, mean - radius, std::atan2(xy, half) / 2};
}

/// The slope s with M s = (x, y), M symmetric; 0 along directions in which M is almost zero.
inline std::array<double, 2> slope_of(double xx, double xy, double yy, double x, double y) {
  const Axes2 axes = axes_of(xx, xy, yy);
  const double c = std::cos(axes.angle), s = std::sin(axes.angle);
  const double along = axes.large > 0 ? (c * x + s * y) / axes.large : 0;
  const double across = axes.small > 1e-12 * axes.large ? (c * y - s * x) / axes.small : 0;
  return {c * along - s * across, s * along + c * across};
}

}  // namespace tetwarp

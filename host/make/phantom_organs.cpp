/// @file phantom_organs.cpp
/// Tubes along curves and branching vessels as rods.
#include "host/make/phantom_organs.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/counter_hash.hpp"
#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
constexpr int rods_per_span = 6;

Point3 moved(const Point3& x, const Point3& direction, double length) {
  return {x[0] + length * direction[0], x[1] + length * direction[1], x[2] + length * direction[2]};
}

Point3 normalized(const Point3& x) {
  return moved({0, 0, 0}, x, 1 / std::sqrt(dot(x, x)));
}

/// Point at `t` in [0, 1] between b and c of the Catmull-Rom curve through a, b, c, d.
Point3 on_curve(const Point3& a, const Point3& b, const Point3& c, const Point3& d, double t) {
  Point3 point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double slope = c[axis] - a[axis];
    const double square = 2 * a[axis] - 5 * b[axis] + 4 * c[axis] - d[axis];
    const double cube = 3 * (b[axis] - c[axis]) + d[axis] - a[axis];
    point[axis] = b[axis] + 0.5 * t * (slope + t * (square + t * cube));
  }
  return point;
}
}  // namespace

void Organs::ellipsoid(double level, const Point3& center, const Point3& radii, double lean) {
  add({center, radii, lean}, level);
}

void Organs::rod(
    double level, const Point3& from, const Point3& to, double from_radius, double to_radius) {
  organs_.push_back({Rod{from, to, from_radius, to_radius}, level});
}

void Organs::tube(double level,
                  const std::vector<Point3>& points,
                  double first_radius,
                  double last_radius) {
  const std::size_t last = points.size() - 1;
  const double taper = (last_radius - first_radius) / (rods_per_span * static_cast<double>(last));
  Point3 from = points.front();
  double radius = first_radius;
  for (std::size_t span = 0; span < last; ++span) {
    for (int step = 1; step <= rods_per_span; ++step) {
      const Point3 to =
          on_curve(points[span == 0 ? 0 : span - 1], points[span], points[span + 1],
                   points[std::min(span + 2, last)], static_cast<double>(step) / rods_per_span);
      rod(level, from, to, radius, radius + taper);
      radius += taper;
      from = to;
    }
  }
}

void Organs::tree(const Tree& tree,
                  const Point3& from,
                  const Point3& direction,
                  double length,
                  double radius,
                  std::uint64_t branch) {
  grow(tree, 0, from, normalized(direction), length, radius, branch);
}

void Organs::grow(const Tree& tree,
                  int generation,
                  const Point3& from,
                  const Point3& direction,
                  double length,
                  double radius,
                  std::uint64_t branch) {
  const auto chance = [&](std::uint64_t n) { return unit_of(8 * branch + n); };
  const double own_length = length * (0.85 + 0.3 * chance(0));
  const Point3 to = moved(from, direction, own_length);
  if (generation == tree.generations || tree.region.distance(to[0], to[1], to[2]) > -4) return;
  rod(tree.level, from, to, radius, 0.8 * radius);
  // Two children, bent to opposite sides in a random plane through the branch.
  const Point3 any{chance(1) - 0.5, chance(2) - 0.5, chance(3) - 0.5};
  const Point3 sideways = normalized(moved(any, direction, -dot(any, direction)));
  const double bend = 0.45 + 0.35 * chance(4);
  grow(tree, generation + 1, to, normalized(moved(direction, sideways, bend)),
       tree.shortening * length, 0.74 * radius, 2 * branch);
  grow(tree, generation + 1, to, normalized(moved(direction, sideways, -bend)),
       tree.shortening * length, 0.74 * radius, 2 * branch + 1);
}

}  // namespace tetwarp

/// @file crossing.hpp
/// Counts triangles of two surfaces that cross, by an exact test that shares no code with the
/// detection.
#pragma once
#include <cstdint>
#include <tetwarp/scene_parts.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/oracles/triangle_intersection.hpp"

namespace tetwarp::test {

/// Points on the straight ways from a to b.
inline std::vector<Point3> between(const std::vector<Point3>& a,
                                   const std::vector<Point3>& b,
                                   double part) {
  std::vector<Point3> points(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    points[i] = plus(times(1 - part, a[i]), times(part, b[i]));
  }
  return points;
}

inline std::int64_t crossing_count(const Surface& a, const Surface& b) {
  return static_cast<std::int64_t>(
      reference::intersecting_triangles({a.points, a.triangles}, {b.points, b.triangles}).size());
}

}  // namespace tetwarp::test

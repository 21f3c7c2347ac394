/// @file side_point.hpp
/// A point of one side of a pair of features, as a weighted mean of vertices.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/base/point3.hpp"
#include "host/simulate/contact/scene_surfaces.hpp"

namespace tetwarp {

/// Up to three vertices of one side with weights.
struct SidePoint {
  std::array<std::int32_t, 3> vertex{-1, -1, -1};
  std::array<double, 3> weight{0, 0, 0};
  double radius = 0;
};

inline Point3 lerp(const Point3& a, const Point3& b, double s) {
  return {a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1]), a[2] + s * (b[2] - a[2])};
}

inline Point3 mean_of(const SidePoint& side, const std::vector<Point3>& vertices) {
  Point3 sum{0, 0, 0};
  for (std::size_t k = 0; k < 3 && side.vertex[k] >= 0; ++k) {
    sum = plus(sum, times(side.weight[k], at(vertices, side.vertex[k])));
  }
  return sum;
}

inline Point3 way_of(const SidePoint& side, const SurfaceMotion& motion) {
  return minus(mean_of(side, motion.end.vertices), mean_of(side, motion.start.vertices));
}

inline MaterialPoint material_of(const SidePoint& side,
                                 const SceneSurfaces& scene,
                                 std::int32_t body) {
  MaterialPoint point;
  if (scene.is_rigid[static_cast<std::size_t>(body)] != 0) return point;
  const std::int32_t first = at(scene.surfaces.bodies, body).first_vertex;
  for (std::size_t k = 0; k < 3 && side.vertex[k] >= 0; ++k) {
    point.vertex[k] = side.vertex[k] - first;
    point.weight[k] = side.weight[k];
  }
  return point;
}

inline Point3 any_across(const Point3& direction) {
  std::size_t axis = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    if (std::abs(direction[i]) < std::abs(direction[axis])) axis = i;
  }
  Point3 along{0, 0, 0};
  along[axis] = 1;
  return unit(cross(direction, cross(along, direction)));
}

/// The unit vector along `apart`; where it vanishes, along or against `otherwise`.
/// @param start  apart at the start of the motion: decides the side
inline Point3 normal_of(const Point3& apart, const Point3& otherwise, const Point3& start) {
  if (norm(apart) > 0) return unit(apart);
  const Point3 normal = norm(otherwise) > 0 ? unit(otherwise) : Point3{0, 0, 1};
  return dot(normal, start) < 0 ? times(-1, normal) : normal;
}

}  // namespace tetwarp

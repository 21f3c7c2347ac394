/// @file touch_areas.hpp
/// Triangles around vertices, and the mean area of the vertices of a body.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"
#include "kernels/collide/touch_area.hpp"

namespace tetwarp {

class TouchAreas {
 public:
  /// @param surfaces  kept by the caller
  explicit TouchAreas(const CollisionSurfaces& surfaces);

  /// For the functions of kernels/collide/touch_area.hpp, on the host.
  TouchAreaView view() const;

  std::span<const std::int32_t> triangles_around(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(triangle).subspan(static_cast<std::size_t>(start[v]),
                                       static_cast<std::size_t>(start[v + 1] - start[v]));
  }

  std::vector<std::int32_t> start, triangle;  ///< of vertex v: triangle[start[v]..start[v + 1]]
  std::vector<double> mean_area;              ///< [bodies] of a vertex [m^2]

 private:
  const CollisionSurfaces& surfaces_;
};

/// Coordinates of points, for stages.
inline View<const double> numbers_of(const std::vector<Point3>& points) {
  return {points.empty() ? nullptr : points[0].data(),
          3 * static_cast<std::int64_t>(points.size())};
}
inline Vec3 vec3_of(const Point3& x) {
  return {{x[0], x[1], x[2]}};
}
inline Point3 point_of(const Vec3& x) {
  return {x[0], x[1], x[2]};
}

}  // namespace tetwarp

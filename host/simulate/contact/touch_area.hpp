/// @file touch_area.hpp
/// The area that a vertex stands for in a contact.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/collide/collision_surfaces.hpp"

namespace tetwarp {

/// Triangles around vertices, and how two meshes share the area where they touch.
class TouchAreas {
 public:
  /// @param surfaces  kept by the caller
  explicit TouchAreas(const CollisionSurfaces& surfaces);

  /// The share of CollisionSurfaces::vertex_area that is seen along a direction: each triangle by
  /// the cosine of its angle. Of triangles that face along it, or of those that face against it,
  /// whichever is more: a sheet touches with either side, a body with its outside.
  /// @param direction  unit
  double seen(std::int32_t vertex,
              const Point3& direction,
              const std::vector<Point3>& vertices) const;

  /// Area of a triangle seen along a direction, negative against it.
  double facing(std::int32_t triangle,
                const Point3& direction,
                const std::vector<Point3>& vertices) const;
  /// 1 where seen() is the area that faces along the direction, else -1.
  double side(std::int32_t vertex,
              const Point3& direction,
              const std::vector<Point3>& vertices) const;

  /// Share of the area of `body` where it touches `other`, both meshes: shares add up to 1, the
  /// finer mesh has more. 1/2 for equal ones.
  double share(std::int32_t body, std::int32_t other) const;

  std::span<const std::int32_t> triangles_around(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(triangle_).subspan(static_cast<std::size_t>(start_[v]),
                                        static_cast<std::size_t>(start_[v + 1] - start_[v]));
  }

 private:
  struct Seen {
    double all = 0, along = 0, against = 0;  ///< areas
  };
  Seen around(std::int32_t vertex,
              const Point3& direction,
              const std::vector<Point3>& vertices) const;

  const CollisionSurfaces& surfaces_;
  std::vector<std::int32_t> start_, triangle_;  ///< of each vertex
  std::vector<double> mean_area_;               ///< [bodies] of a vertex [m^2]
};

}  // namespace tetwarp

/// @file touch_area.hpp
/// The area of the contact of a vertex.
#pragma once
#include <cstdint>

#include "kernels/base/vec3.hpp"

namespace tetwarp {

/// The triangles around each vertex; constant during a simulation.
struct TouchAreaView {
  View<const std::int32_t> start, triangle;  ///< of each vertex, see TouchAreas
  View<const std::int32_t> corners;          ///< [triangles][3] vertices
  View<const double> vertex_area;            ///< [vertices] CollisionSurfaces::vertex_area
  View<const double> mean_area;  ///< [bodies] of a vertex [m^2]; infinite where vertices within
                                 ///< flat faces touch nothing: the other body has their area
};

/// Twice the area of a triangle times its normal.
TETWARP_HD Vec3 double_normal(const TouchAreaView& areas,
                              std::int64_t triangle,
                              View<const double> vertices) {
  const std::int32_t* const corner = areas.corners.data + 3 * triangle;
  const Vec3 x = vec3_at(vertices, corner[0]);
  return cross(minus(vec3_at(vertices, corner[1]), x), minus(vec3_at(vertices, corner[2]), x));
}

/// Area of a triangle seen along a direction, negative against it.
TETWARP_HD double facing_area(const TouchAreaView& areas,
                              std::int64_t triangle,
                              const Vec3& direction,
                              View<const double> vertices) {
  return dot(double_normal(areas, triangle, vertices), direction) / 2;
}

/// Areas of the triangles around a vertex.
struct AreasAround {
  double all = 0, along = 0, against = 0;  ///< along, against: projections of the triangles that
                                           ///< face along and against a direction [m^2]
};
TETWARP_HD AreasAround areas_around(const TouchAreaView& areas,
                                    std::int64_t vertex,
                                    const Vec3& direction,
                                    View<const double> vertices) {
  AreasAround sum;
  for (std::int32_t k = areas.start[vertex]; k < areas.start[vertex + 1]; ++k) {
    const Vec3 normal = double_normal(areas, areas.triangle[k], vertices);
    const double along = dot(normal, direction) / 2;
    sum.all += norm(normal) / 2;
    (along > 0 ? sum.along : sum.against) += fabs(along);
  }
  return sum;
}

/// The part of a vertex's area that is seen along a direction: each triangle counts by the cosine
/// of the angle between its normal and the direction. Triangles that face along the direction or
/// those that face against it count, whichever have the larger sum: a sheet touches with either
/// side, a body with its outside.
/// @param direction  unit
TETWARP_HD double seen_area(const TouchAreaView& areas,
                            std::int64_t vertex,
                            const Vec3& direction,
                            View<const double> vertices) {
  const double area = areas.vertex_area[vertex];
  if (!(area > 0)) return 0;
  const AreasAround around = areas_around(areas, vertex, direction, vertices);
  const double most = max_of(around.along, around.against);
  return around.all > 0 ? area * min_of(1.0, most / around.all) : 0;
}

constexpr double largest_area = 1e300;  ///< finite ones are smaller [m^2]

/// The weight of `body` in the area of a contact with `other`, both meshes: the weights of the two
/// add up to 1, the finer mesh has the larger one.
TETWARP_HD double area_share(const TouchAreaView& areas, std::int64_t body, std::int64_t other) {
  const double own = areas.mean_area[body], others = areas.mean_area[other];
  if (!(own + others < largest_area)) return own == others ? 0.5 : own < others ? 1 : 0;
  return own + others > 0 ? others / (own + others) : 0.5;
}

}  // namespace tetwarp

/// @file nearest_cones.hpp
/// Edges and vertices in a direction from their surface: whether they are what is nearest there,
/// and which face around them is.
#pragma once
#include <cstdint>

#include "kernels/base/vec3.hpp"
#include "kernels/collide/touch_area.hpp"

namespace tetwarp {

/// Places of vertices at a time of a motion along straight ways.
struct VerticesAt {
  View<const double> start, end;
  double time;  ///< 0: `end` is not read

  TETWARP_HD Vec3 operator[](std::int64_t vertex) const {
    const Vec3 from = vec3_at(start, vertex);
    return time > 0 ? lerp(from, vec3_at(end, vertex), time) : from;
  }
};

/// Whether no triangle beside an edge is nearer than the edge itself to a point in direction
/// `toward` from it: false where this direction leans over a triangle.
/// @param edge    its two vertices
/// @param toward  unit, across the edge
/// @param sine    of the angle by which it may lean
TETWARP_ANY_EXEC inline bool edge_is_nearest(const TouchAreaView& areas,
                                             const std::int32_t* edge,
                                             const Vec3& toward,
                                             const VerticesAt& vertices,
                                             double sine) {
  const std::int32_t v = edge[0], w = edge[1];
  const Vec3 at_v = vertices[v], along = unit(minus(vertices[w], at_v));
  for (std::int32_t k = areas.start[v]; k < areas.start[v + 1]; ++k) {
    const std::int32_t* const corner = areas.corners.data + 3 * std::int64_t{areas.triangle[k]};
    if (corner[0] != w && corner[1] != w && corner[2] != w) continue;
    for (int c = 0; c < 3; ++c) {
      if (corner[c] == v || corner[c] == w) continue;
      const Vec3 into = minus(vertices[corner[c]], at_v);
      const Vec3 across = unit(minus(into, times(dot(into, along), along)));
      if (dot(across, toward) > sine) return false;
    }
  }
  return true;
}

/// Whether no edge from a vertex is nearer than the vertex itself to a point in direction `toward`
/// from it; parameters as of edge_is_nearest().
TETWARP_ANY_EXEC inline bool vertex_is_nearest(const TouchAreaView& areas,
                                               std::int32_t vertex,
                                               const Vec3& toward,
                                               const VerticesAt& vertices,
                                               double sine) {
  const Vec3 place = vertices[vertex];
  for (std::int32_t k = areas.start[vertex]; k < areas.start[vertex + 1]; ++k) {
    const std::int32_t* const corner = areas.corners.data + 3 * std::int64_t{areas.triangle[k]};
    for (int c = 0; c < 3; ++c) {
      if (corner[c] == vertex) continue;
      const Vec3 along = minus(vertices[corner[c]], place);
      if (dot(along, toward) > sine * norm(along)) return false;
    }
  }
  return true;
}

/// The normal of that of the triangles around a vertex or an edge which is nearest to a direction.
/// @param vertex, count  the vertex, or both of the edge
/// @param toward  unit
/// @param cosine  of the largest angle to it; where none is as near, `toward`
TETWARP_ANY_EXEC inline Vec3 nearest_face_normal(const TouchAreaView& areas,
                                                 const std::int32_t* vertex,
                                                 int count,
                                                 const Vec3& toward,
                                                 const VerticesAt& vertices,
                                                 double cosine) {
  Vec3 nearest = toward;
  const std::int32_t v = vertex[0];
  for (std::int32_t k = areas.start[v]; k < areas.start[v + 1]; ++k) {
    const std::int32_t* const corner = areas.corners.data + 3 * std::int64_t{areas.triangle[k]};
    if (count == 2 && corner[0] != vertex[1] && corner[1] != vertex[1] && corner[2] != vertex[1]) {
      continue;
    }
    const Vec3 x = vertices[corner[0]];
    const Vec3 normal = cross(minus(vertices[corner[1]], x), minus(vertices[corner[2]], x));
    const double length = norm(normal), along = dot(normal, toward);
    if (!(along > cosine * length)) continue;
    cosine = along / length;
    nearest = times(1 / length, normal);
  }
  return nearest;
}

}  // namespace tetwarp

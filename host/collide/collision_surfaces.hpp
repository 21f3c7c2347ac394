/// @file collision_surfaces.hpp
/// What can touch in a scene: triangles, spheres, capsules and planes of all bodies, and which
/// bodies may meet. Constant during a simulation.
///
/// A sphere is a vertex with a radius; a capsule is an edge with a radius and its two vertices with
/// the same radius. Bodies are numbered as ModelPoint::body: bodies of the scene, then obstacles.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/volume.hpp>

#include "kernels/collide/collide_item.hpp"

namespace tetwarp {

/// The parts of one body or obstacle; of one that does not collide all ranges are empty.
struct CollisionBody {
  std::int32_t first_vertex = 0, vertex_end = 0;
  std::int32_t first_edge = 0, edge_end = 0;
  std::int32_t first_triangle = 0, triangle_end = 0;
  std::int32_t first_plane = 0, plane_end = 0;
  bool has_unknowns = false;    ///< false: fixed or prescribed; two of these are never a pair
  bool is_rigid = false;        ///< all parts are fixed in one frame
  bool touches_itself = false;  ///< pairs of its own features count, unless they share a vertex
};

struct CollisionSurfaces {
  std::vector<CollisionBody> bodies;

  std::vector<std::int32_t> vertex_body;  ///< [vertices]
  std::vector<double> vertex_radius;      ///< [vertices] [m]; 0: corner of triangles
  std::vector<double> vertex_area;  ///< [vertices] a third of the area of the triangles around
                                    ///< the vertex at the start [m^2]; 0 with a radius
  std::vector<std::array<std::int32_t, 2>> edges;  ///< vertices; of triangles, each edge once, and
                                                   ///< axes of capsules
  std::vector<double> edge_radius;                 ///< [edges] [m]
  /// [vertices], [edges] within a flat face of a body that keeps its shape: not the first feature
  /// of any pair, nor the second edge; or empty: none.
  std::vector<std::uint8_t> vertex_is_flat, edge_is_flat;
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< vertices, counter-clockwise from outside
  std::vector<std::int32_t> plane_body;                ///< [planes]

  /// Pairs of bodies a < b that never touch, sorted. A body touches itself only with
  /// CollisionBody::touches_itself.
  std::vector<std::array<std::int32_t, 2>> forbidden;
  double thickness = 0;  ///< contact distance h_c [m], > 0
};

/// A half-space: points x with normal . (x - point) < 0 are inside.
struct PlanePlace {
  Point3 point{0, 0, 0};
  Point3 normal{0, 0, 1};  ///< unit
};

/// Places of all vertices and planes at one time.
struct SurfacePlaces {
  std::vector<Point3> vertices;    ///< [vertices], world
  std::vector<PlanePlace> planes;  ///< [planes]
};

/// A motion of all surfaces from start to end. Vertices of bodies without a frame move straight; a
/// body that turns follows its frame (kernels/collide/moving_points.hpp).
struct SurfaceMotion {
  SurfacePlaces start, end;
  /// [vertices] [m] 0 where the way is straight. At the fraction t of the motion a vertex is within
  /// 4 t (1 - t) sagitta of the straight way. At distance r from the axis of a frame that turns by
  /// any angle, sagitta = r angle^2 / 8.
  std::vector<double> sagitta;
  /// [bodies] with turn 0 where all goes straight; or empty: turns are bounded by sagittas only, so
  /// that pairs touch earlier, and planes turn by the least angle about their points.
  std::vector<TurningFrame> frames = {};
  /// The same motion up to rounding, in memory of the detector's device; or empty: the detector
  /// copies the members above. Which bodies a plane may reach is always found from those.
  MotionView resident = {};
};

}  // namespace tetwarp

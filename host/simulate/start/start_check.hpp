/// @file start_check.hpp
/// Checks that the bodies of a scene do not intersect at the start.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/collide/detector.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Two bodies that intersect, or are nearer than the thickness.
struct StartConflict {
  enum class Kind : std::uint8_t {
    crosses,   ///< triangles of both have common points
    inside,    ///< the first body, or a part of it, is within the second
    overlaps,  ///< a round body or a plane, and another one
    near       ///< apart or touching, nearer than the thickness
  };
  std::array<std::int32_t, 2> bodies{0, 0};  ///< as ModelPoint::body, ascending but for `inside`;
                                             ///< equal: a body with itself
  Kind kind = Kind::near;
  Point3 place{0, 0, 0};  ///< world
  double distance = 0;    ///< `near`: of the two surfaces; `overlaps`: negative [m]

  bool is_intersection() const { return kind != Kind::near; }
};

/// One conflict for every two bodies that have one, sorted by bodies: of the kinds that apply the
/// first in the order above; of `near` and `overlaps` the smallest distance. Distances are compared
/// up to the rounding of coordinates, see InsetPlaces.
std::vector<StartConflict> start_conflicts(const SceneSurfaces& scene,
                                           const SurfacePlaces& places,
                                           Detector& detector,
                                           int threads);

/// @returns whether bodies are nearer than the thickness
/// @throws std::invalid_argument  in one line: bodies that intersect, where and by how much, and
///         the remedy
bool check_start(const Scene& scene,
                 const SceneSurfaces& surfaces,
                 const SurfacePlaces& places,
                 Detector& detector,
                 int threads);

}  // namespace tetwarp

/// @file start_check.hpp
/// Checks that the bodies of a scene are apart at the start.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "host/collide/detector.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Two bodies that are nearer than the thickness, or overlap.
struct StartConflict {
  enum class Kind : std::uint8_t {
    crosses,  ///< an edge of one passes a triangle of the other
    inside,   ///< the first body, or a part of it, is within the second
    near      ///< nearer than the thickness
  };
  std::array<std::int32_t, 2> bodies{0, 0};  ///< as ModelPoint::body, ascending but for `inside`;
                                             ///< equal: a body with itself
  Kind kind = Kind::near;
  Point3 place{0, 0, 0};  ///< world
  double distance = 0;    ///< `near`: of the two surfaces [m]
};

/// One conflict for every two bodies that have one, sorted by bodies: of the kinds that apply the
/// first in the order above; of `near` the smallest distance.
std::vector<StartConflict> start_conflicts(const SceneSurfaces& scene,
                                           const SurfacePlaces& places,
                                           Detector& detector,
                                           int threads);

/// @throws std::invalid_argument  in one line: bodies that overlap or are nearer than the
///         thickness, where and by how much, and the remedy
void check_start(const Scene& scene,
                 const SceneSurfaces& surfaces,
                 const SurfacePlaces& places,
                 Detector& detector,
                 int threads);

}  // namespace tetwarp

/// @file pair_touch.hpp
/// Where and in which direction two features touch.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include <tetwarp/contact_tracker.hpp>

#include "host/collide/detector.hpp"
#include "host/simulate/contact/scene_surfaces.hpp"

namespace tetwarp {

/// Side a is that of the pair's first feature.
struct PairTouch {
  PairKind kind = PairKind::vertex_face;
  std::int32_t a = 0, b = 0;                  ///< the features, as in TouchingPair
  std::int32_t body_a = 0, body_b = 0;        ///< bodies, then obstacles
  Point3 point_a{0, 0, 0}, point_b{0, 0, 0};  ///< of the material, at the start; `gap` apart
  Point3 normal{0, 0, 1};                     ///< unit, from b to a
  Point3 way{0, 0, 0};                   ///< by which a moves relative to b as first expected [m]
  double gap = 0;                        ///< at the start along the normal, less the thickness [m]
  double distance = 0;                   ///< between the surfaces at the start [m]
  double time = 0;                       ///< of the hit, 0 to 1; 0 where they are near at the start
  MaterialPoint material_a, material_b;  ///< on deformable bodies
  std::array<std::int32_t, 3> part_b{-1, -1, -1};     ///< vertices of the face, edge or vertex b
  std::array<std::int32_t, 3> nearest_b{-1, -1, -1};  ///< those of it that the nearest point is of
  std::int32_t end = 0;   ///< 1, 2: at an end of the overlap of two capsules side by side
  bool is_inside = true;  ///< nearest point inside a face; of two edges: between all ends
};

/// @param motion  in which the pair was found
/// @param first   motion of the first detection of the step
PairTouch touch_of(const TouchingPair& pair,
                   const SceneSurfaces& scene,
                   const SurfaceMotion& motion,
                   const SurfaceMotion& first);

/// Capsules side by side touch along a line: the touches at both ends of their overlap, that at the
/// start of axis a first. Nothing for other pairs, for axes that differ by 10 degrees or more, and
/// where the axes do not overlap.
std::optional<std::array<PairTouch, 2>> end_touches_of(const TouchingPair& pair,
                                                       const SceneSurfaces& scene,
                                                       const SurfaceMotion& motion,
                                                       const SurfaceMotion& first);

}  // namespace tetwarp

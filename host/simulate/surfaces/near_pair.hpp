/// @file near_pair.hpp
/// The nearest points of a pair of features as sums of vertices.
#pragma once
#include <array>
#include <cstdint>

#include "host/collide/detector.hpp"

namespace tetwarp {

/// p_a - p_b is the sum of weight x over the vertices. Of a plane, p_b is the foot of p_a on it.
struct NearPair {
  std::array<std::int32_t, 4> vertex{-1, -1, -1, -1};
  std::array<double, 4> weight{0, 0, 0, 0};  ///< positive of vertices of a, negative of those of b
  Point3 normal{0, 0, 1};                    ///< unit, from b to a; zero where the points coincide
  double distance = 0;                       ///< of the surfaces, radii subtracted [m]
  Point3 place{0, 0, 0};                     ///< half-way between both surfaces
  std::array<std::int32_t, 2> bodies{0, 0};  ///< of a and b
};

NearPair near_pair(const TouchingPair& pair,
                   const CollisionSurfaces& surfaces,
                   const SurfacePlaces& places);

/// Whether a segment and a triangle have a common point. Exact except for rounding, which matters
/// only where edges or corners touch. False where both lie in one plane: then two of their features
/// are at distance zero.
bool crosses(
    const Point3& from, const Point3& to, const Point3& a, const Point3& b, const Point3& c);

}  // namespace tetwarp

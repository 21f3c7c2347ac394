/// @file round_shape.hpp
/// Bodies and obstacles whose exact shape touches: spheres and capsules.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// All points within `radius` of a segment; a sphere where its ends are equal.
struct RoundShape {
  Point3 from{0, 0, 0}, to{0, 0, 0};  ///< in the frame of the geometry
  double radius = 0;                  ///< [m]

  bool is_sphere() const { return from == to; }
};

/// The shape of a rigid sphere or capsule for which the scene gives no surface.
std::optional<RoundShape> round_shape_of(const Body& body);
std::optional<RoundShape> round_shape_of(const Obstacle& obstacle);

/// A closed triangle surface with its vertices on the shape, in the same frame.
Surface surface_of(const RoundShape& shape);

/// "bodies[2] 'ball'", or "obstacles[0] 'floor'" for numbers from the number of bodies on.
std::string place_of_body(const Scene& scene, std::int32_t body);

}  // namespace tetwarp

/// @file round_shape.hpp
/// Bodies and obstacles that touch by their exact shape: spheres and capsules.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// All points within `radius` of a line; a sphere where its ends are the same.
struct RoundShape {
  Point3 from{0, 0, 0}, to{0, 0, 0};  ///< in the frame of the geometry
  double radius = 0;                  ///< [m]

  bool is_sphere() const { return from == to; }
};

/// Of rigid spheres and capsules whose surface the scene does not give.
std::optional<RoundShape> round_shape_of(const Body& body);
std::optional<RoundShape> round_shape_of(const Obstacle& obstacle);

/// Closed triangle surface whose points are on the shape, in the same frame.
Surface surface_of(const RoundShape& shape);

/// "bodies[2] 'ball'", from the number of bodies on "obstacles[0] 'floor'".
std::string place_of_body(const Scene& scene, std::int32_t body);

}  // namespace tetwarp

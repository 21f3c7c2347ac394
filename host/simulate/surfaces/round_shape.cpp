/// @file round_shape.cpp
/// Recognizes spheres and capsules among shapes and obstacles.
#include "host/simulate/surfaces/round_shape.hpp"

#include <cmath>
#include <variant>

#include "host/base/point3.hpp"
#include "host/scene/pose.hpp"
#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {

/// About the number of triangles of a round obstacle that adheres.
constexpr std::int64_t round_triangles = 1280;

/// The smallest rotation that turns the z axis onto `axis`, or minus the z axis if `axis` points
/// down: the two ends of a capsule are equal.
Quaternion turn_from_z(const Point3& axis) {
  const Point3 up = axis[2] < 0 ? times(-1, axis) : axis;
  const Point3 turn = cross({0, 0, 1}, up);
  return normalized({1 + up[2], turn[0], turn[1], turn[2]});
}

}  // namespace

std::optional<RoundShape> round_shape_of(const Body& body) {
  const auto* shape = std::get_if<Shape>(&body.geometry);
  if (body.kind != BodyKind::rigid || shape == nullptr) return std::nullopt;
  if (std::holds_alternative<Surface>(body.surface)) return std::nullopt;
  if (const auto* ball = std::get_if<EllipsoidShape>(shape)) {
    const auto [a, b, c] = ball->radii;
    if (a != b || b != c) return std::nullopt;
    return RoundShape{{0, 0, 0}, {0, 0, 0}, a};
  }
  if (const auto* capsule = std::get_if<CapsuleShape>(shape)) {
    const double half = capsule->length / 2;
    return RoundShape{{0, 0, half == 0 ? 0 : -half}, {0, 0, half}, capsule->radius};
  }
  return std::nullopt;
}

std::optional<RoundShape> round_shape_of(const Obstacle& obstacle) {
  if (const auto* ball = std::get_if<SphereObstacle>(&obstacle.geometry)) {
    return RoundShape{ball->center, ball->center, ball->radius};
  }
  if (const auto* capsule = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
    return RoundShape{capsule->from, capsule->to, capsule->radius};
  }
  return std::nullopt;
}

Surface surface_of(const RoundShape& shape) {
  const Point3 middle = times(0.5, plus(shape.from, shape.to));
  const Point3 line = minus(shape.to, shape.from);
  const Point3 radii{shape.radius, shape.radius, shape.radius};
  Surface surface = shape.is_sphere() ? make_shape_surface(EllipsoidShape{radii}, round_triangles)
                                      : make_shape_surface(CapsuleShape{shape.radius, norm(line)},
                                                           round_triangles);
  const Quaternion turn = shape.is_sphere() ? Quaternion{1, 0, 0, 0} : turn_from_z(unit(line));
  for (Point3& x : surface.points) x = plus(middle, rotate(turn, x));
  return surface;
}

std::string place_of_body(const Scene& scene, std::int32_t body) {
  const auto index = static_cast<std::size_t>(body);
  const std::size_t count = scene.bodies.size();
  if (index < count) {
    return "bodies[" + std::to_string(index) + "] '" + scene.bodies[index].name + "'";
  }
  return "obstacles[" + std::to_string(index - count) + "] '" +
         scene.obstacles[index - count].name + "'";
}

}  // namespace tetwarp

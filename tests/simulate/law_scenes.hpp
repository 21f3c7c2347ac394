/// @file law_scenes.hpp
/// Scenes whose contact has a closed form, and measures of their states.
#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {

inline constexpr double earth = 9.81;  ///< [m/s^2]

/// Gravity in the frame of a slope that falls along x by `angle`.
inline Point3 gravity_on_slope(double angle) {
  return {earth * std::sin(angle), 0, -earth * std::cos(angle)};
}

/// A plane through the origin that the bodies are on, and their friction.
inline Scene floor_scene(std::vector<Body> bodies, double time_step, double friction) {
  Scene scene = scene_of(std::move(bodies), time_step);
  scene.thickness = 1e-4;
  scene.solver.contact_tolerance = 1e-12;
  scene.contact.material.friction = friction;
  scene.obstacles = {{.name = "floor", .geometry = PlaneObstacle{}}};
  return scene;
}

/// A homogeneous ball: the mass and inertia of a sphere, not of its triangles. It touches by its
/// exact shape.
inline Body exact_ball(const std::string& name, double radius, const Point3& position) {
  Body ball;
  ball.name = name;
  ball.kind = BodyKind::rigid;
  ball.geometry = Shape{EllipsoidShape{{radius, radius, radius}}};
  ball.pose.position = position;
  const double mass = 1.7, moment = 0.4 * mass * radius * radius;
  ball.rigid.mass = mass;
  ball.rigid.inertia = {moment, moment, moment, 0, 0, 0};
  return ball;
}

inline Body elastic_ball(const std::string& name,
                         double radius,
                         std::int64_t tets,
                         const Point3& position) {
  Body ball = elastic_box(name, {1, 1, 1}, {1, 1, 1});
  ball.geometry = Shape{EllipsoidShape{{radius, radius, radius}}};
  ball.lattice = Lattice{.tets = tets};
  ball.pose.position = position;
  return ball;
}

}  // namespace tetwarp::test

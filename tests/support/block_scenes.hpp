/// @file block_scenes.hpp
/// Blocks on, under and beside planes, for the tests of the contact laws.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/support/rigid_bodies.hpp"

namespace tetwarp::test {

constexpr double block_edge = 0.1;                      // m
constexpr double block_face = block_edge * block_edge;  // m^2
constexpr double gravity = 9.81;                        // m/s^2

/// A cube of 1 kg.
inline RigidBox unit_block(int points_per_edge = 2) {
  return make_box(Eigen::Vector3d::Constant(block_edge / 2), 1.0, points_per_edge);
}

/// Surfaces that bond at the first touch and never debond.
inline ContactMaterial glue(double stiffness, double friction = 0.5, double intensity = 1) {
  return {.friction = friction, .stiffness = stiffness, .initial_intensity = intensity};
}

inline WorldOptions world_options(const ContactMaterial& material, double time_step) {
  WorldOptions options;
  options.time_step = time_step;
  options.tracking.materials = {material};
  options.tracking.touch_distance = 1e-9;
  options.solving.tolerance = 1e-12;
  return options;
}

/// A cube glued to the ceiling above it.
inline RigidWorld hung_block(const WorldOptions& options, int points_per_edge = 2) {
  RigidWorld world(options);
  world.planes.push_back({{0, 0, block_edge / 2}, {0, 0, -1}});
  world.boxes.push_back(unit_block(points_per_edge));
  return world;
}

/// A cube on the floor.
inline RigidWorld laid_block(const WorldOptions& options) {
  RigidWorld world(options);
  world.planes.push_back({{0, 0, -block_edge / 2}, {0, 0, 1}});
  world.boxes.push_back(unit_block());
  return world;
}

/// A cube whose lower face is glued to a vertical wall.
inline RigidWorld walled_block(const WorldOptions& options) {
  RigidWorld world(options);
  world.planes.push_back({{-block_edge / 2, 0, 0}, {1, 0, 0}});
  world.boxes.push_back(unit_block());
  const double half = std::numbers::sqrt2 / 2;
  world.boxes[0].pose.rotation = {half, 0, half, 0};  // body z to world x
  return world;
}

/// Cubes one on the other on the floor, from the lowest up; each `ratio` times as heavy as the one
/// below.
inline RigidWorld stacked_blocks(const WorldOptions& options, int count, double ratio = 1) {
  RigidWorld world(options);
  world.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  for (int level = 0; level < count; ++level) {
    RigidBox box = make_box(Eigen::Vector3d::Constant(block_edge / 2), std::pow(ratio, level));
    box.pose.position = {0, 0, block_edge * (level + 0.5)};
    world.boxes.push_back(box);
  }
  return world;
}

inline void run(RigidWorld& world, int steps) {
  for (int step = 0; step < steps; ++step) world.step();
}

}  // namespace tetwarp::test

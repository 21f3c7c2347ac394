/// @file touch_run.hpp
/// Scenes with contact for tests of whole steps, and what holds in them.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "host/simulate/state/checkpoint_bytes.hpp"
#include "tests/simulate/touch_scenes.hpp"

namespace tetwarp::test {

/// Replaces four bytes of a checkpoint at random by a number beyond all indices, with its checksum.
inline std::vector<std::byte> damaged(std::vector<std::byte> bytes, std::mt19937& random) {
  const std::int32_t number = 1'000'000;
  std::uint64_t checksum = 0;
  const std::size_t end = bytes.size() - sizeof checksum;
  std::uniform_int_distribution<std::size_t> place(4, end / 4 - 1);
  std::memcpy(bytes.data() + 4 * place(random), &number, sizeof number);
  checksum = checksum_of({bytes.data(), end});
  std::memcpy(bytes.data() + end, &checksum, sizeof checksum);
  return bytes;
}

inline Obstacle plane_at(double height) {
  Obstacle plane;
  plane.name = "floor";
  plane.geometry = PlaneObstacle{{0, 0, 1}, {0, 0, height}};
  return plane;
}

/// A plate of two triangles, seen from above counter-clockwise.
inline Obstacle plate_at(double height, double half) {
  Obstacle plate;
  plate.name = "plate";
  plate.geometry = Surface{
      {{-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}},
      {{0, 1, 2}, {0, 2, 3}}};
  return plate;
}

inline Body elastic_ball(const std::string& name, double radius, const Point3& position) {
  Body body;
  body.name = name;
  body.geometry = Shape{EllipsoidShape{{radius, radius, radius}}};
  body.lattice = Lattice{.cells = {{4, 4, 4}}};
  body.material = {1e5, 0.3, 1000};
  body.pose.position = position;
  return body;
}

/// Exact solves, for comparisons to rounding.
inline Scene tight(Scene scene) {
  scene.solver.contact_tolerance = 1e-12;
  return scene;
}

inline double lowest(const std::vector<Point3>& points) {
  double low = points.front()[2];
  for (const Point3& x : points) low = std::min(low, x[2]);
  return low;
}

/// All positions and velocities, body after body.
inline std::vector<Point3> places_of(const Simulator& simulator) {
  std::vector<Point3> all;
  for (std::size_t b = 0; b < simulator.scene().bodies.size(); ++b) {
    for (const auto& list : {simulator.node_positions(b), simulator.node_velocities(b),
                             simulator.surface_positions(b)}) {
      all.insert(all.end(), list.begin(), list.end());
    }
  }
  return all;
}

/// mass (v_{n+1} - v_n) / dt = mass g + all forces on the body, to a share of the largest force.
inline void expect_balance(Simulator& simulator, const StepRecord& before, double share) {
  const StepRecord& after = simulator.record();
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    const BodyRecord& body = after.bodies[b];
    const double mass = simulator.body(b).mass;
    Point3 sum = times(mass, simulator.scene().gravity);
    double size = norm(sum) + mass * norm(body.velocity) / simulator.scene().time_step;
    for (const Point3& force : {body.contact_force, body.support_force, body.handle_force,
                                body.coupling_force, body.load_force}) {
      sum = plus(sum, force);
      size += norm(force);
    }
    const Point3 change =
        times(mass / simulator.scene().time_step, minus(body.velocity, before.bodies[b].velocity));
    EXPECT_LE(norm(minus(change, sum)), share * size) << "body " << b << ", time " << after.time;
  }
}

}  // namespace tetwarp::test

/// @file test_law_throws.cpp
/// Bodies thrown at others with up to ten diameters a step: nothing passes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simulate/crossing.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {
struct Flight {
  std::int64_t crossings = 0;  ///< triangles that cross, over all states and instants between
  std::int64_t clamped_steps = 0, most_passes = 0, most_contacts = 0, unconverged = 0;
  double least_distance = 1, lowest = 1;  ///< [m]
  bool is_finite = true;
};

/// Steps a scene and looks for crossings of `a` with `b` at the end of each step and at 16 instants
/// between. The nodes of elastic bodies move straight in a step that is not divided.
template <class SurfaceOf>
Flight fly(const Scene& scene, int steps, const SurfaceOf& surface_b) {
  Simulator simulator(scene);
  Flight flight;
  const auto& triangles = simulator.body(0).surface.triangles;
  std::vector<Point3> before = simulator.surface_positions(0),
                      before_b = surface_b(simulator).points;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    const std::vector<Point3> after = simulator.surface_positions(0);
    const Surface b = surface_b(simulator);
    const int instants = record.substeps == 1 ? 17 : 1;
    for (int i = 1; i <= instants; ++i) {
      const double part = static_cast<double>(i) / instants;
      flight.crossings += crossing_count({between(before, after, part), triangles},
                                         {between(before_b, b.points, part), b.triangles});
    }
    for (const Point3& x : after) flight.lowest = std::min(flight.lowest, x[2]);
    before = after;
    before_b = b.points;
    flight.clamped_steps += record.clamped_islands > 0;
    flight.unconverged += !record.converged;
    flight.most_passes = std::max(flight.most_passes, record.contact_passes / record.substeps);
    flight.most_contacts = std::max(flight.most_contacts, record.contacts);
    flight.least_distance = std::min(flight.least_distance, record.smallest_distance);
    flight.is_finite = flight.is_finite && std::isfinite(record.energy.total());
  }
  return flight;
}

struct Throw {
  double speed, youngs_modulus, time_step;
};

Surface plate() {
  return {{{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

/// At two triangles, far larger than the ball: the ball never reaches their other side, and no end
/// check has to shorten a step.
TEST(ThrownBall, NeverPassesAPlateOfTwoTriangles) {
  for (const Throw& t : {Throw{20, 1e5, 8e-3},
                         {100, 1e5, 8e-3},
                         {100, 1e6, 8e-3},
                         {50, 1e4, 8e-3},
                         {5, 1e4, 4e-3}}) {
    Body ball = elastic_ball("ball", 0.04, 232, {0.3, 0.1, 0.09});
    ball.surface = std::int64_t{600};
    ball.material = {t.youngs_modulus, 0.3, 1000};
    ball.velocity = {0.3 * t.speed, 0, -t.speed};
    Scene scene = scene_of({ball}, t.time_step);
    scene.thickness = 3e-4;
    scene.contact.material.friction = 0.3;
    scene.solver.linear_tolerance = 1e-6;
    scene.obstacles = {{.name = "plate", .geometry = plate()}};
    const Flight flight = fly(scene, 12, [](const Simulator&) { return plate(); });
    EXPECT_EQ(flight.crossings, 0) << t.speed << " " << t.youngs_modulus;
    EXPECT_EQ(flight.clamped_steps, 0) << t.speed << " " << t.youngs_modulus;
    EXPECT_GT(flight.least_distance, 0.5 * 3e-4) << t.speed << " " << t.youngs_modulus;
    EXPECT_GT(flight.lowest, 0);
    EXPECT_GT(flight.most_contacts, 0);
    EXPECT_LE(flight.most_passes, 5);
    EXPECT_TRUE(flight.is_finite);
  }
}

/// At another elastic body, with pairs of edges.
TEST(ThrownBall, NeverEntersAnElasticBlock) {
  int steps = 0;
  std::int64_t clamped = 0;
  for (const Throw& t : {Throw{2, 1e5, 8e-3}, {10, 1e5, 8e-3}, {10, 1e6, 8e-3}, {10, 1e4, 4e-3}}) {
    Body ball = elastic_ball("ball", 0.04, 232, {0.005, 0.003, 0.1});
    ball.surface = std::int64_t{296};
    ball.material = {t.youngs_modulus, 0.3, 1000};
    ball.velocity = {0, 0, -t.speed};
    Body block = elastic_box("block", {0.1, 0.1, 0.04}, {5, 5, 2});
    block.material = {t.youngs_modulus, 0.3, 1000};
    Scene scene = scene_of({ball, block}, t.time_step);
    scene.gravity = {0, 0, 0};
    scene.thickness = 3e-4;
    scene.contact.material.friction = 0.3;
    scene.solver.linear_tolerance = 1e-6;
    const Flight flight = fly(scene, 40, [](const Simulator& simulator) {
      return Surface{simulator.surface_positions(1), simulator.body(1).surface.triangles};
    });
    EXPECT_EQ(flight.crossings, 0) << t.speed << " " << t.youngs_modulus;
    EXPECT_GT(flight.least_distance, 0.1 * 3e-4) << t.speed << " " << t.youngs_modulus;
    EXPECT_LE(flight.most_passes, 5);
    EXPECT_GT(flight.most_contacts, 10);
    EXPECT_TRUE(flight.is_finite);
    clamped += flight.clamped_steps;
    steps += 40;
  }
  EXPECT_LE(static_cast<double>(clamped), 0.03 * steps);
}

/// A capsule that rolls about its axis and turns about the vertical dips one end below the other in
/// every step, by up to half of the product of both angles and its length: here as far as the
/// thickness. It goes on at its speed.
TEST(Throw, OfACapsuleThatRollsAndTurnsIsNotHeldUp) {
  const double quarter = std::acos(-1.0) / 2;
  for (const double thickness : {2e-6, 5e-6, 2e-5}) {
    for (const double turn : {0.5, 1.0, -1.0, 2.0}) {
      Body capsule;
      capsule.name = "capsule";
      capsule.kind = BodyKind::rigid;
      capsule.geometry = Shape{CapsuleShape{.radius = 0.024, .length = 0.055}};
      capsule.pose.position = {0, 0, 0.0245};
      capsule.pose.rotation = {std::cos(quarter / 2), 0, std::sin(quarter / 2), 0};
      capsule.velocity = {0.7, 0.2, -0.3};
      capsule.angular_velocity = {5, 0, turn};
      Scene scene = floor_scene({capsule}, 0.01, 0);
      scene.thickness = thickness;
      scene.solver.contact_tolerance = 1e-6;
      Simulator simulator(scene);
      std::int64_t clamped = 0;
      for (int n = 0; n < 100; ++n) {
        simulator.step();
        clamped += simulator.record().clamped_islands;
        if (n > 20) {
          EXPECT_GT(simulator.record().smallest_distance, 0.5 * thickness)
              << thickness << " " << turn << " " << n;
        }
      }
      EXPECT_EQ(clamped, 0) << thickness << " " << turn;
      const Point3 v = simulator.record().bodies[0].velocity;
      EXPECT_NEAR(std::hypot(v[0], v[1]), std::hypot(0.7, 0.2), 1e-9);
    }
  }
}

/// Damping takes spins there: their reciprocals are infinite.
TEST(Throw, OfABodyWhoseSpinIsBelowNormalNumbersEndsOnTheFloor) {
  for (const double spin : {1e-160, 1e-300, 1e-310, 5e-324}) {
    Body box = rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0.1});
    box.angular_velocity = {spin, 0, -spin};
    box.velocity = {0, 0, -2};
    Simulator simulator(floor_scene({box}, 0.01, 0));
    for (int n = 0; n < 10; ++n) {
      simulator.step();
      EXPECT_GT(simulator.record().smallest_distance, 0) << spin << " " << n;
    }
  }
}

}  // namespace
}  // namespace tetwarp::test

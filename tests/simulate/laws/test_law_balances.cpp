/// @file test_law_balances.cpp
/// Momentum, energy and forces of scenes with contact; what must not change them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// An elastic ball hits another one and a rigid box off their centers, in free flight.
Scene collision(double friction, double tolerance) {
  Body a = elastic_ball("a", 0.05, 90, {-0.08, 0.01, 0});
  a.velocity = {1, 0, 0.1};
  a.angular_velocity = {0, 2, 1};
  Body b = elastic_ball("b", 0.05, 90, {0.08, 0, 0.02});
  b.velocity = {-1, 0.2, 0};
  Body c = rigid_box("c", {0.04, 0.04, 0.04}, {0, 0.12, 0.01});
  c.velocity = {0, -1.5, 0};
  Scene scene = scene_of({a, b, c}, 0.004);
  scene.gravity = {0, 0, 0};
  scene.thickness = 1e-4;
  scene.contact.material.friction = friction;
  scene.solver.contact_tolerance = tolerance;
  return scene;
}

/// Once they move as one, what is left to solve is the rounding of their velocities.
TEST(Collision, OfARowOfBallsConvergesInEveryStep) {
  for (const double gap : {0.0, 5e-4, 1e-3, 1e-2}) {
    for (const double time_step : {1e-3, 5e-3, 1e-2}) {
      std::vector<Body> bodies;
      for (int i = 0; i < 5; ++i) {
        const double x = i == 0 ? 0 : 0.15 + (i - 1) * (0.1 + gap);
        bodies.push_back(exact_ball("ball" + std::to_string(i), 0.05, {x, 0, 0}));
      }
      bodies[0].velocity = {1, 0, 0};
      Scene scene = scene_of(std::move(bodies), time_step);
      scene.gravity = {0, 0, 0};
      Simulator simulator(scene);
      for (int n = 0; n < static_cast<int>(0.4 / time_step); ++n) {
        simulator.step();
        EXPECT_TRUE(simulator.record().converged) << gap << " " << time_step << " " << n;
      }
      for (const BodyRecord& ball : simulator.record().bodies) {
        EXPECT_NEAR(ball.velocity[0], 0.2, 1e-4) << gap << " " << time_step;
      }
    }
  }
}

/// Momentum is kept as exactly as contacts are solved.
TEST(Collision, KeepsTheMomentumToTheToleranceOfContacts) {
  for (const double friction : {0.0, 0.4}) {
    for (const double tolerance : {1e-4, 1e-5}) {
      Simulator simulator(collision(friction, tolerance));
      const StepRecord start = simulator.record();
      double impulse = 0, sum_of_sizes = 0;
      for (std::size_t b = 0; b < 3; ++b) {
        sum_of_sizes += simulator.body(b).mass * norm(start.bodies[b].velocity);
      }
      for (int n = 0; n < 25; ++n) {
        simulator.step();
        const StepRecord& record = simulator.record();
        Point3 sum{0, 0, 0};
        for (const BodyRecord& body : record.bodies) {
          sum = plus(sum, body.contact_force);
          impulse += norm(body.contact_force) * 0.004;
        }
        EXPECT_LT(norm(sum), 1e-9) << n;
        EXPECT_TRUE(record.converged) << n;
      }
      const StepRecord& end = simulator.record();
      EXPECT_GT(impulse, 0.5);  // [N s]: they did collide
      EXPECT_LT(distance_of(end.momentum, start.momentum), 0.2 * tolerance * sum_of_sizes)
          << friction << " " << tolerance;
      // Points that touch are a thickness apart, and the stiffness turns within a step.
      EXPECT_LT(distance_of(end.angular_momentum, start.angular_momentum), 2e-3) << friction;
      EXPECT_LT(end.energy.total(), start.energy.total());
    }
  }
}

/// Of each body: mass dv/dt = weight + forces, where nothing is damped but deformation.
TEST(Contact, ForcesBalanceTheMotionOfEachBody) {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {2, 2, 2});
  soft.pose.position = {0, 0, 0.051};
  const Body hard = exact_ball("hard", 0.03, {0.01, 0, 0.14});
  Scene scene = floor_scene({soft, hard}, 0.004, 0.4);
  Simulator simulator(scene);
  StepRecord before = simulator.record();
  for (int n = 0; n < 60; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    for (std::size_t b = 0; b < 2; ++b) {
      const double mass = simulator.body(b).mass;
      const Point3 change =
          times(mass / 0.004, minus(record.bodies[b].velocity, before.bodies[b].velocity));
      const Point3 force = plus(times(mass, scene.gravity), record.bodies[b].contact_force);
      EXPECT_LT(distance_of(change, force), 1e-8 * (1 + norm(force))) << n << " " << b;
    }
    before = record;
  }
}

/// A pile comes to rest: no step gains energy.
TEST(Pile, LosesEnergyInEveryStep) {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {2, 2, 2});
  soft.pose.position = {0, 0, 0.06};
  Body ball = elastic_ball("ball", 0.03, 90, {0.01, 0.005, 0.16});
  Body hard = rigid_box("hard", {0.03, 0.03, 0.02}, {-0.01, 0, 0.23});
  Scene scene = floor_scene({soft, ball, hard}, 0.004, 0.4);
  scene.solver.contact_tolerance = 1e-4;
  scene.solver.linear_tolerance = 1e-8;
  Simulator simulator(scene);
  const double start = simulator.record().energy.total();
  double energy = start;
  for (int n = 0; n < 300; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    EXPECT_LT(record.energy.total(), energy + 1e-4 * start) << n;
    EXPECT_GT(record.smallest_distance, 0) << n;
    energy = record.energy.total();
  }
  EXPECT_LT(energy, start);
}

/// A pile of three bodies, in the order given.
std::vector<Point3> pile_places(const std::array<std::size_t, 3>& order, int steps) {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {2, 2, 2});
  soft.pose.position = {0, 0, 0.052};
  Body hard = exact_ball("hard", 0.03, {0.011, 0.007, 0.14});
  Body sheet = sheet_body("sheet", {0.2, 0.2}, {4, 4});
  std::get<Sheet>(sheet.geometry).origin = {-0.1, -0.1, 0.175};
  const std::array<Body, 3> bodies{soft, hard, sheet};
  Scene scene = floor_scene({bodies[order[0]], bodies[order[1]], bodies[order[2]]}, 0.004, 0.3);
  Simulator simulator(scene);
  run(simulator, steps);
  std::vector<Point3> centers(3);
  for (std::size_t i = 0; i < 3; ++i) centers[order[i]] = simulator.record().bodies[i].center;
  EXPECT_GT(simulator.record().contacts, 4);
  return centers;
}

TEST(Contact, DoesNotDependOnTheOrderOfBodies) {
  const auto expected = pile_places({0, 1, 2}, 25);
  for (const auto& order : {std::array<std::size_t, 3>{2, 0, 1}, {1, 2, 0}, {2, 1, 0}}) {
    const auto found = pile_places(order, 25);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_LT(distance_of(found[i], expected[i]), 1e-12) << i;
  }
}

}  // namespace
}  // namespace tetwarp::test

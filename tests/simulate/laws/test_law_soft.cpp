/// @file test_law_soft.cpp
/// Cloth and elastic bodies on planes: a chain that partly lies on the floor, a ball that rolls.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A strip of length 1.3 hangs over a span of 1 with its middle on a floor 0.25 below its ends.
/// Each side is half a catenary z = a (cosh(x / a) - 1) that leaves the floor level; what is left
/// of the length is flat.
struct LyingChain {
  double a = 0, side = 0, arc = 0;
};
LyingChain lying_chain() {
  double low = 0.01, high = 10;
  LyingChain chain;
  for (int i = 0; i < 200; ++i) {
    chain.a = (low + high) / 2;
    chain.side = chain.a * std::acosh(1 + 0.25 / chain.a);
    chain.arc = chain.a * std::sinh(chain.side / chain.a);
    // The flatter the sides (the larger a), the less length is used.
    (2 * (chain.arc - chain.side) > 0.3 ? low : high) = chain.a;
  }
  return chain;
}

struct Hanging {
  double error = 0, floor_force = 0;
};

Hanging hang(std::int64_t segments) {
  const double thickness = 1e-4;
  Body strip = sheet_body("strip", {1.3, 0.05}, {segments, 1});
  strip.cloth = {1.0, 1e5, 1e5, 0};
  strip.damping = {4, 0};
  strip.self = false;
  strip.fixed = {NodeSelection{{0, segments + 1}}};
  strip.driven = {{{NodeSelection{{segments, 2 * segments + 1}}},
                   {{0, Point3{0, 0, 0}}, {0.5, Point3{-0.3, 0, 0}}}}};
  Scene scene = floor_scene({strip}, 0.02, 0);
  scene.solver.linear_tolerance = 1e-10;
  scene.solver.contact_tolerance = 1e-8;
  std::get<PlaneObstacle>(scene.obstacles[0].geometry).point = {0, 0, -0.25 - thickness};
  Simulator simulator(scene);
  run(simulator, 400);

  const LyingChain chain = lying_chain();
  Hanging result;
  const auto positions = simulator.node_positions(0);
  for (std::int64_t u = 0; u <= segments; ++u) {
    const double s = 1.3 * static_cast<double>(u) / static_cast<double>(segments);
    const double from_end = std::min(s, 1.3 - s), on_arc = std::max(chain.arc - from_end, 0.);
    const double along = chain.a * std::asinh(on_arc / chain.a);
    double x = from_end < chain.arc ? chain.side - along : chain.side + from_end - chain.arc;
    if (s > 0.65) x = 1 - x;
    const double z = chain.a * (std::cosh(along / chain.a) - 1) - 0.25;
    const Point3& p = positions[static_cast<std::size_t>(u)];
    result.error = std::max(result.error, std::hypot(p[0] - x, p[2] - z));
  }
  result.floor_force = -simulator.record().obstacle_forces[0][2];
  return result;
}

TEST(Cloth, LiesOnAFloorBetweenTwoHalvesOfACatenary) {
  const Hanging coarse = hang(16), fine = hang(32);
  EXPECT_LT(fine.error, 2e-3);
  EXPECT_GT(coarse.error / fine.error, 2);
  // The floor carries what lies on it.
  const double flat = 1.3 - 2 * lying_chain().arc;
  EXPECT_NEAR(fine.floor_force / (0.05 * earth * flat), 1, 0.05);
}

/// Of the acceleration 5/7 g sin of a rigid ball on a slope of 20 degrees: what a ball reaches that
/// touches by the points of its surface.
double rolling(std::int64_t points,
               double youngs_modulus,
               double time_step,
               std::int64_t tets = 232) {
  Body ball = elastic_ball("ball", 0.04, tets, {0, 0, 0.04 + 2e-4});
  ball.material = {youngs_modulus, 0.4, 1000};
  ball.surface = 2 * points;
  Scene scene = floor_scene({ball}, time_step, 0.6);
  scene.solver.contact_tolerance = 1e-6;
  scene.solver.linear_tolerance = 1e-8;
  const double angle = 20 * std::numbers::pi / 180;
  scene.gravity = gravity_on_slope(angle);
  Simulator simulator(scene);
  const auto speed_at = [&](double time) {
    while (simulator.time() < time - 1e-9) simulator.step();
    return simulator.record().bodies[0].velocity[0];
  };
  const double early = speed_at(0.1), late = speed_at(0.5);
  EXPECT_EQ(simulator.record().inverted, 0);
  return (late - early) / 0.4 / (5 / 7. * earth * std::sin(angle));
}

/// The rest is lost where points hit the slope: the more points, the less.
TEST(ElasticBall, RollsTheFasterTheMorePointsItHas) {
  const double few = rolling(100, 1e6, 2e-3), many = rolling(400, 1e6, 2e-3);
  EXPECT_NEAR(few, 0.675, 0.08);
  EXPECT_NEAR(many, 0.801, 0.05);
  EXPECT_LT(few, many);
}

/// The more so with shorter steps and smaller cells.
TEST(LongElasticBall, RollsNearlyAsFastAsARigidOne) {
  const double points = rolling(1600, 1e6, 2e-3), more_points = rolling(6400, 1e6, 2e-3);
  const double steps = rolling(6400, 1e6, 5e-4), cells = rolling(6400, 1e6, 5e-4, 1800);
  EXPECT_GT(points, 0.8);
  EXPECT_LT(points, more_points);
  EXPECT_LT(more_points, steps);
  EXPECT_LT(steps, cells);
  EXPECT_GT(cells, 0.95);
  EXPECT_LT(cells, 1);
}

}  // namespace
}  // namespace tetwarp::test

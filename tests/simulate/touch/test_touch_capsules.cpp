/// Capsules that lie along others: held at both ends of what they share, they do not tip.
#include <array>
#include <cmath>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

constexpr double right_angle = 1.5707963267948966;

Body lying_capsule(double radius, double length, const Point3& position) {
  Body body = rigid_capsule("capsule", radius, length, position);
  body.pose.rotation = {std::cos(right_angle / 2), 0, std::sin(right_angle / 2), 0};  // along x
  return body;
}

Obstacle bar_at(const std::string& name, double y, double z, double radius) {
  Obstacle bar;
  bar.name = name;
  bar.geometry = CapsuleObstacle{{-0.2, y, z}, {0.2, y, z}, radius};
  return bar;
}

struct Rest {
  double turn = 0;  ///< largest angular velocity [rad/s]
  double drop = 0;  ///< of the center, at the end [m]
  std::int64_t contacts = 0;
};

Rest rest_of(const Scene& scene, int steps) {
  Simulator simulator(scene);
  const double start = simulator.record().bodies[0].center[2];
  Rest rest;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    rest.turn = std::max(rest.turn, norm(simulator.record().bodies[0].angular_velocity));
  }
  rest.drop = start - simulator.record().bodies[0].center[2];
  rest.contacts = simulator.record().contacts;
  return rest;
}

/// In the groove between two bars, which end under a fifth of it on one side only: two contacts
/// with each.
TEST(Capsules, LieInTheGrooveOfTwoBars) {
  const double r = 0.02, h = 1e-4, half = 0.02, reach = 2 * r + h;
  const double height = std::sqrt(reach * reach - half * half);
  for (const double x : {0.0, 0.15}) {
    Scene scene = tight(scene_of({lying_capsule(r, 0.2, {x, 0, height + 1e-6})}, 0.005));
    scene.obstacles = {bar_at("left", -half, 0, r), bar_at("right", half, 0, r)};
    scene.thickness = h;
    scene.contact.material.friction = 0.3;
    const Rest rest = rest_of(scene, 100);
    EXPECT_EQ(rest.contacts, 4) << x;
    EXPECT_LE(rest.turn, 1e-6) << x;
    EXPECT_NEAR(rest.drop, 1e-6, 1e-7) << x;
  }
}

/// On top of one bar, an unstable equilibrium that symmetry holds: no turn about the other axes.
TEST(Capsules, LieOnOneBar) {
  const double r = 0.02, h = 1e-4;
  Scene scene = tight(scene_of({lying_capsule(r, 0.2, {0.03, 0, 2 * r + h + 1e-6})}, 0.005));
  scene.obstacles = {bar_at("bar", 0, 0, r)};
  scene.thickness = h;
  scene.contact.material.friction = 0.3;
  const Rest rest = rest_of(scene, 40);
  EXPECT_EQ(rest.contacts, 2);
  EXPECT_LE(rest.turn, 1e-6);
  EXPECT_NEAR(rest.drop, 1e-6, 1e-7);
}

/// On a box: over its middle, and beyond its end by less than a half.
TEST(Capsules, LieOnABox) {
  const double r = 0.02, h = 1e-4;
  for (const double x : {0.0, 0.08}) {
    Body box = rigid_box("box", {0.1, 0.05, 0.03}, {0, 0, 0.03 + h + 1e-6});
    Scene scene =
        tight(scene_of({lying_capsule(r, 0.18, {x, 0.01, 0.06 + 2 * h + r + 2e-6}), box}, 0.005));
    scene.obstacles = {plane_at(0)};
    scene.thickness = h;
    scene.contact.material.friction = 0.3;
    const Rest rest = rest_of(scene, 60);
    EXPECT_GE(rest.contacts, 2) << x;
    EXPECT_LE(rest.turn, 1e-6) << x;
    EXPECT_NEAR(rest.drop, 2e-6, 1e-7) << x;
  }
}

/// A plank on two ridges: all contacts with it lie on two parallel lines.
TEST(Boxes, LieOnParallelEdges) {
  const double h = 1e-4;
  Scene scene =
      tight(scene_of({rigid_box("plank", {0.1, 0.05, 0.01}, {0, 0, 0.01 + h + 1e-6})}, 0.005));
  for (const double x : {-0.06, 0.08}) {
    Obstacle ridge;
    ridge.name = x < 0 ? "left" : "right";
    ridge.geometry = Surface{{{x, -0.04, 0},
                              {x, 0.04, 0},
                              {x - 0.02, -0.04, -0.02},
                              {x - 0.02, 0.04, -0.02},
                              {x + 0.02, -0.04, -0.02},
                              {x + 0.02, 0.04, -0.02}},
                             {{0, 1, 3}, {0, 3, 2}, {1, 0, 4}, {1, 4, 5}}};
    scene.obstacles.push_back(ridge);
  }
  scene.thickness = h;
  scene.contact.material.friction = 0.3;
  const Rest rest = rest_of(scene, 60);
  EXPECT_GE(rest.contacts, 4);
  EXPECT_LE(rest.turn, 1e-9);
  EXPECT_NEAR(rest.drop, 1e-6, 1e-7);
}

/// They hit off their centers and turn as they slide: a contact along the normal at the first hit
/// does not keep them apart. They must go on, not be held up: the way is that of the velocities.
TEST(Capsules, ACapsuleAndABallSlidePastEachOther) {
  Body capsule = rigid_capsule("capsule", 0.02, 0.1, {-0.006, -0.013, 0.013});
  capsule.pose.rotation = {std::cos(0.49), 0, std::sin(0.49), 0};
  capsule.velocity = {1, 0, 0};
  Body ball = rigid_ball("ball", 0.03, {0.14, -0.004, -0.003});
  ball.velocity = {-1, 0, 0};
  Scene scene = scene_of({capsule, ball}, 0.005);
  scene.gravity = {0, 0, 0};
  scene.contact.material.friction = 0;
  Simulator simulator(scene);
  std::array<Point3, 2> way{};
  const StepRecord start = simulator.record();
  int held_steps = 0;
  for (int n = 0; n < 100; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    held_steps += record.clamped_islands > 0;
    for (std::size_t b = 0; b < 2; ++b) {
      way[b] = plus(way[b], times(scene.time_step, record.bodies[b].velocity));
    }
    EXPECT_LE(record.energy.total(), start.energy.total() * (1 + 1e-9));
  }
  const StepRecord& end = simulator.record();
  EXPECT_LT(norm(end.momentum), norm(start.momentum) + 1e-9);
  EXPECT_LE(held_steps, 5);
  for (std::size_t b = 0; b < 2; ++b) {
    const Point3 moved = minus(end.bodies[b].center, start.bodies[b].center);
    EXPECT_LT(norm(minus(moved, way[b])), 0.05 * norm(way[b])) << b;
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_contact_stress.cpp
/// Hard scenes: whatever the numbers are, results are finite and nothing intersects.
#include <gtest/gtest.h>

#include "tests/simulate/stress_watch.hpp"

namespace tetwarp::test {
namespace {

void expect_sound(const Watch& watch) {
  EXPECT_TRUE(watch.is_finite);
  EXPECT_EQ(watch.crossings, 0);
  EXPECT_GT(watch.least_distance, 0);
  EXPECT_GT(watch.most_contacts, 0);
}

/// A soft block on the floor, a hard one that falls on it.
Scene two_blocks(double youngs_soft, double youngs_hard, double time_step, double friction) {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.03}, {2, 2, 1});
  soft.pose.position = {0, 0, 0.0305};
  soft.material = {youngs_soft, 0.4, 1000};
  Body hard = elastic_box("hard", {0.03, 0.03, 0.03}, {2, 2, 2});
  hard.pose.position = {0.01, 0, 0.0915};
  hard.velocity = {0.2, 0, -0.5};
  hard.material = {youngs_hard, 0.4, 1000};
  Scene scene = floor_scene({soft, hard}, time_step, friction);
  scene.solver.contact_tolerance = 1e-4;
  scene.solver.linear_tolerance = 1e-6;
  return scene;
}

TEST(ContactStress, StiffnessesMayDifferAMillionfold) {
  for (const double ratio : {1., 1e3, 1e6}) {
    for (const bool is_hard_below : {false, true}) {
      const double low = 1e4, high = 1e4 * ratio;
      Simulator simulator(
          two_blocks(is_hard_below ? high : low, is_hard_below ? low : high, 0.004, 0.3));
      const Watch watch = watch_steps(simulator, 40);
      SCOPED_TRACE(testing::Message() << ratio << " " << is_hard_below << ": " << watch);
      expect_sound(watch);
    }
  }
}

TEST(ContactStress, TimeStepsMayBeFrom100MicrosecondsTo50Milliseconds) {
  for (const double time_step : {1e-4, 1e-3, 0.01, 0.05}) {
    Simulator simulator(two_blocks(3e4, 1e6, time_step, 0.3));
    const Watch watch = watch_steps(simulator, time_step < 1e-3 ? 100 : 40, 4);
    SCOPED_TRACE(testing::Message() << time_step << ": " << watch);
    expect_sound(watch);
    EXPECT_LT(watch.most_energy, 1e-3);
  }
}

TEST(ContactStress, FrictionMayBeNoneOrAThousand) {
  for (const double friction : {0., 1., 1e3}) {
    Simulator simulator(two_blocks(3e4, 1e6, 0.004, friction));
    const Watch watch = watch_steps(simulator, 40, 4);
    SCOPED_TRACE(testing::Message() << friction << ": " << watch);
    expect_sound(watch);
  }
}

/// A thousand kilometers from the origin, places are rounded to 1e-10 m.
TEST(ContactStress, BodiesMayBeFarFromTheOrigin) {
  Scene scene = two_blocks(3e4, 1e5, 0.004, 0.3);
  const Point3 offset{1e6, -1e6, 1e6};
  for (Body& body : scene.bodies) body.pose.position = plus(body.pose.position, offset);
  std::get<PlaneObstacle>(scene.obstacles[0].geometry).point = offset;
  Simulator near(two_blocks(3e4, 1e5, 0.004, 0.3)), far(scene);
  const Watch watch = watch_steps(far, 25);
  run(near, 25);
  SCOPED_TRACE(testing::Message() << watch);
  expect_sound(watch);
  for (std::size_t b = 0; b < 2; ++b) {
    const Point3 moved = minus(far.record().bodies[b].center, offset);
    EXPECT_LT(distance_of(moved, near.record().bodies[b].center), 1e-4) << b;
  }
}

/// Nothing holds bodies together or apart but their contact.
TEST(ContactStress, ZeroGravityLeavesBodiesAtRest) {
  Scene scene = two_blocks(3e4, 1e5, 0.01, 0.3);
  scene.gravity = {0, 0, 0};
  scene.bodies[0].pose.position[2] = 0.0301 + 1e-12;
  scene.bodies[1].pose.position[2] = 0.0902 + 2e-12;
  scene.bodies[1].velocity = {0, 0, 0};
  Simulator simulator(scene);
  const Watch watch = watch_steps(simulator, 20);
  SCOPED_TRACE(testing::Message() << watch);
  expect_sound(watch);
  EXPECT_LT(simulator.record().energy.kinetic, 1e-12);
}

/// Two walls close to less than a body's size: the walls stop where the body would have no room,
/// and the step says so.
TEST(ContactStress, BodiesBetweenClosingWallsAreNotCrushed) {
  for (const bool is_rigid : {false, true}) {
    Body body = is_rigid ? rigid_box("body", {0.05, 0.05, 0.05}, {0, 0, 0})
                         : elastic_box("body", {0.05, 0.05, 0.05}, {2, 2, 2});
    Scene scene = scene_of({body}, 0.005);
    scene.gravity = {0, 0, 0};
    scene.thickness = 1e-4;
    scene.solver.linear_tolerance = 1e-6;
    const Path down{{0, Point3{0, 0, 0}}, {0.2, Point3{0, 0, -0.06}}};
    const Path up{{0, Point3{0, 0, 0}}, {0.2, Point3{0, 0, 0.06}}};
    scene.obstacles = {
        {.name = "lid", .geometry = PlaneObstacle{{0, 0, -1}, {0, 0, 0.055}}, .path = down},
        {.name = "floor", .geometry = PlaneObstacle{{0, 0, 1}, {0, 0, -0.055}}, .path = up}};
    Simulator simulator(scene);
    const Watch watch = watch_steps(simulator, 46);
    SCOPED_TRACE(testing::Message() << is_rigid << ": " << watch);
    expect_sound(watch);
    EXPECT_GT(watch.stalled, 0);
    EXPECT_GT(watch.clamped + watch.unconverged + watch.divided, 0);
  }
}

/// Rigid bodies of all kinds one above the other, at five to ten diameters a step.
TEST(ContactStress, RigidBodiesMayBeFast) {
  std::vector<Body> bodies;
  for (int i = 0; i < 3; ++i) {
    Body body = i % 2 == 0 ? rigid_box("b" + std::to_string(i), {0.02, 0.03, 0.01}, {})
                           : exact_ball("b" + std::to_string(i), 0.02, {});
    body.pose.position = {0.002 * i, -0.001 * i, 0.1 + 0.1 * i};
    body.velocity = {0, 0, -20.0 * (i + 1)};
    body.angular_velocity = {10.0 * i, 20, 0};
    if (i % 2 == 1) body.surface = std::int64_t{80};
    bodies.push_back(body);
  }
  Scene scene = floor_scene(bodies, 0.008, 0.3);
  scene.solver.contact_tolerance = 1e-4;
  Simulator simulator(scene);
  const Watch watch = watch_steps(simulator, 20);
  SCOPED_TRACE(testing::Message() << watch);
  expect_sound(watch);
}

}  // namespace
}  // namespace tetwarp::test

/// Scripts, handles, loads and what a user's hand moves between steps.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/simulate/model/motion.hpp"
#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

TEST(Path, IsLinearAndHeld) {
  const Path path{{1, Point3{0, 0, 0}, {0, 0, 1}}, {3, Point3{2, 4, 0}, {0, 0, 2}}};
  EXPECT_EQ(place_at(path, 0)->displacement, (Point3{0, 0, 0}));
  EXPECT_EQ(place_at(path, 2)->displacement, (Point3{1, 2, 0}));
  EXPECT_EQ(place_at(path, 2)->axis_angle, (Point3{0, 0, 1.5}));
  EXPECT_EQ(place_at(path, 9)->displacement, (Point3{2, 4, 0}));
}

TEST(Path, LetsGoFromTheTimeOfNothing) {
  const Path path{{0, Point3{0, 0, 0}}, {0.3, std::nullopt}, {0.5, Point3{1, 0, 0}}};
  EXPECT_TRUE(place_at(path, 0.2).has_value());
  EXPECT_FALSE(place_at(path, 3 * 0.1).has_value());  // 0.30000000000000004
  EXPECT_FALSE(place_at(path, 0.299999999999999999).has_value());
  EXPECT_TRUE(place_at(path, 0.5).has_value());
}

Body jaw(const Motion& motion) {
  Body body;
  body.name = "jaw";
  body.kind = BodyKind::scripted;
  body.geometry = Shape{BoxShape{{0.1, 0.1, 0.3}}};
  body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{1, 1, 3}};
  body.motion = motion;
  return body;
}

/// A hinge turns about its point; its bodies reach the exact places of each time.
TEST(Script, FollowsItsHinge) {
  Simulator simulator(
      scene_of({jaw(Hinge{{0, 0, 1}, {0, 2, 0}, {{0, 0}, {0.5, std::numbers::pi / 2}}})}, 0.05));
  const auto start = simulator.node_positions(0);
  run(simulator, 10);
  const auto end = simulator.node_positions(0);
  const auto surface = simulator.surface_positions(0);

  ASSERT_EQ(start.size(), end.size());
  for (std::size_t n = 0; n < start.size(); ++n) {
    EXPECT_LT(distance_of(end[n], {start[n][2] - 1, start[n][1], 1 - start[n][0]}), 1e-14);
  }
  EXPECT_EQ(surface.size(), simulator.body(0).surface.points.size());
  for (const Point3& x : surface) EXPECT_LT(std::abs(x[2] - 1), 0.1 + 1e-12);
  const auto view = simulator.positions(0);
  EXPECT_EQ(view.node_count, static_cast<std::int64_t>(end.size()));
  EXPECT_EQ(view.xyz[3], end[1][0]);
}

/// Every period of a wave returns the same bits.
TEST(Script, WavesRepeatBitForBit) {
  const Wave wave{.axis = 2, .lateral = 0, .frequency = 1, .envelope = {0.02, 0.08, 0.16}};
  Simulator simulator(scene_of({jaw(wave)}, 0.05));
  std::vector<std::vector<Point3>> period;
  for (int n = 0; n < 20; ++n) {
    period.push_back(simulator.node_positions(0));
    simulator.step();
  }
  EXPECT_GT(distance_of(period[0][0], period[5][0]), 0.01);
  for (int n = 0; n < 100; ++n) {
    EXPECT_EQ(simulator.node_positions(0), period[static_cast<std::size_t>(n % 20)]);
    simulator.step();
  }
}

TEST(Script, CanBeMovedByHand) {
  Scene scene =
      scene_of({jaw(std::monostate{}), rigid_box("box", {0.1, 0.1, 0.1}, {0, 0, -0.5})}, 0.01);
  scene.gravity = {0, 0, 0};
  scene.bodies[1].damping.alpha = 50;
  scene.couplings = {{.a = "box", .b = "jaw", .select_a = {AllSelection{}}, .stiffness = 1e4}};
  Simulator simulator(scene);
  run(simulator, 300);
  const Point3 before = simulator.record().bodies[1].center;
  const std::vector<Point3> at_rest = simulator.node_positions(0);
  simulator.move_script("jaw", {0.3, 0.1, 0}, {0, 0, 0});
  EXPECT_EQ(simulator.node_positions(0), at_rest);  // it follows from the next step on
  simulator.step();
  EXPECT_LT(distance_of(simulator.node_positions(0)[0], plus(at_rest[0], {0.3, 0.1, 0})), 1e-12);
  run(simulator, 600);

  EXPECT_LT(distance_of(simulator.record().bodies[1].center, plus(before, {0.3, 0.1, 0})), 1e-6);
  EXPECT_THROW(simulator.move_script("box", {0, 0, 0}, {0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(simulator.move_script("jaw", {NAN, 0, 0}, {0, 0, 0}), std::invalid_argument);
}

Scene handled(const Path& path) {
  Scene scene = scene_of({rigid_box("box", {0.1, 0.1, 0.1}, {0, 0, 0})}, 0.01);
  scene.handles = {
      {.name = "hand", .body = "box", .select = {AllSelection{}}, .stiffness = 1e3, .path = path}};
  return scene;
}

TEST(Handle, LetsGoAtItsTime) {
  Simulator simulator(handled({{0, Point3{0, 0, 0}}, {0.05, std::nullopt}}));
  for (int n = 0; n < 10; ++n) {
    simulator.step();
    const double force = simulator.record().bodies[0].handle_force[2];
    if (n < 4) {
      EXPECT_GT(force, 0) << n;
    } else {
      EXPECT_EQ(force, 0) << n;
    }
  }
}

TEST(Handle, FollowsTheHandAndLetsGo) {
  Scene scene = handled({});
  scene.gravity = {0, 0, 0};
  scene.bodies[0].damping.alpha = 30;
  Simulator simulator(scene);
  simulator.move_handle("hand", {0, 0.2, 0});
  run(simulator, 500);
  EXPECT_LT(distance_of(simulator.record().bodies[0].center, {0, 0.2, 0}), 1e-6);
  simulator.release_handle("hand");
  simulator.move_handle("hand", {0, 0.3, 0});
  simulator.release_handle("hand");
  run(simulator, 10);

  EXPECT_EQ(simulator.record().bodies[0].handle_force, (Point3{0, 0, 0}));
  EXPECT_LT(distance_of(simulator.record().bodies[0].center, {0, 0.2, 0}), 1e-6);
  EXPECT_THROW(simulator.move_handle("foot", {0, 0, 0}), std::invalid_argument);
}

/// The work of an anchor that drags a body is force times way.
TEST(Handle, WorkIsForceTimesWay) {
  Scene scene = handled({{0, Point3{0, 0, 0}}, {1, Point3{1, 0, 0}}});
  scene.gravity = {0, 0, 0};
  Simulator simulator(scene);
  double work = 0;
  for (int n = 0; n < 20; ++n) {
    simulator.step();
    work += simulator.record().bodies[0].handle_force[0] * 0.01;
  }
  EXPECT_GT(work, 0);
  EXPECT_NEAR(simulator.record().energy.work, work, 1e-12);
}

/// A load acts in the steps with from < t_(n+1) <= to.
TEST(Load, ActsFromItsStartToItsEnd) {
  Scene scene = scene_of({rigid_box("box", {0.1, 0.1, 0.1}, {0, 0, 0})}, 0.1);
  scene.loads = {{.body = "box",
                  .select = {AllSelection{}},
                  .force = Point3{2, 0, 0},
                  .from = 0.1,
                  .to = 0.3}};
  Simulator simulator(scene);
  std::vector<double> forces;
  for (int n = 0; n < 5; ++n) {
    simulator.step();
    forces.push_back(simulator.record().bodies[0].load_force[0]);
  }
  EXPECT_NEAR(forces[0], 0, 1e-14);
  EXPECT_NEAR(forces[1], 2, 1e-12);
  EXPECT_NEAR(forces[2], 2, 1e-12);
  EXPECT_NEAR(forces[3], 0, 1e-14);
}

/// The pressure on a closed surface has no resultant.
TEST(Load, PressureOnAllOfASurfaceIsInBalance) {
  Scene scene = scene_of({elastic_box("box", {0.1, 0.2, 0.1}, {2, 2, 2})}, 0.01);
  scene.loads = {{.body = "box", .select = {AllSelection{}}, .pressure = 1e3}};
  Simulator simulator(scene);
  run(simulator, 5);

  EXPECT_LT(norm(simulator.record().bodies[0].load_force), 1e-10);
  EXPECT_GT(simulator.record().energy.work, 0);  // it is compressed
}

}  // namespace
}  // namespace tetwarp::test

/// Bodies that touch themselves: cloth as it is, elastic bodies where the scene says so. Judged by
/// a test of all pairs of triangles at the ends of steps and at 16 instants between.
#include <cmath>

#include "tests/simulate/touch_judge.hpp"

namespace tetwarp::test {
namespace {

struct SelfTouch {
  std::size_t most = 0;  ///< contacts of the first body with itself in a step
  int steps = 0;         ///< with such contacts
  double impulse = 0;    ///< sum of their sizes [N s]
};

/// Steps, expects that nothing intersects at any time, and counts contacts of the first body with
/// itself.
SelfTouch run_judged(const Scene& scene, int steps) {
  Simulator simulator(scene);
  Judge judge(simulator);
  SelfTouch touch;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    judge.expect_apart();
    std::size_t count = 0;
    for (const ContactPoint& point : simulator.contacts()) {
      if (point.body_a != 0 || point.body_b != 0) continue;
      ++count;
      touch.impulse += norm(point.impulse);
    }
    touch.most = std::max(touch.most, count);
    touch.steps += count > 0;
  }
  return touch;
}

/// A strip of cloth that stands on the floor, leans a little and folds onto itself.
TEST(SelfContact, AStandingStripOfClothFoldsOntoItself) {
  Body cloth = sheet_body("cloth", {0.3, 0.04}, {24, 3});
  auto& sheet = std::get<Sheet>(cloth.geometry);
  sheet.axes = {Point3{std::sin(0.1), 0, std::cos(0.1)}, Point3{0, 1, 0}};
  sheet.origin = {0, -0.02, 0.002};
  Scene scene = scene_of({cloth}, 0.005);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 5e-4;
  scene.contact.material.friction = 0.3;
  scene.solver.linear_tolerance = 1e-6;
  const SelfTouch touch = run_judged(scene, 120);
  EXPECT_GT(touch.most, 4U);
  EXPECT_GT(touch.steps, 20);
  EXPECT_GT(touch.impulse, 0);
}

/// A sheet that falls over a thin bar: its two halves swing together below it.
TEST(SelfContact, HalvesOfASheetOverABarMeet) {
  Body cloth = sheet_body("cloth", {0.24, 0.05}, {32, 6});
  cloth.pose.position = {-0.12, -0.025, 0.2055};
  Obstacle bar;
  bar.name = "bar";
  bar.geometry = CapsuleObstacle{{0, -0.1, 0.2}, {0, 0.1, 0.2}, 0.004};
  Scene scene = scene_of({cloth}, 0.005);
  scene.obstacles = {bar};
  scene.thickness = 5e-4;
  scene.contact.material.friction = 0.5;
  scene.solver.linear_tolerance = 1e-6;
  const SelfTouch touch = run_judged(scene, 120);
  EXPECT_GT(touch.most, 4U);
  EXPECT_GT(touch.steps, 4);
  EXPECT_GT(touch.impulse, 0);
}

/// Three quarters of a soft ring whose ends are pulled together.
Scene ring(bool touches_itself) {
  Body body;
  body.name = "ring";
  body.geometry = Shape{ArcShape{0.04, 0.01, {-2.5, 2.5}}};
  body.lattice = Lattice{.edge = 0.011};
  body.material = {3e3, 0.3, 1000};
  body.self = touches_itself;
  Scene scene = scene_of({body}, 0.005);
  scene.gravity = {0, 0, 0};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.2;
  scene.solver.linear_tolerance = 1e-6;
  for (const double side : {1.0, -1.0}) {
    scene.loads.push_back({.body = "ring",
                           .select = {SphereSelection{{-0.032, side * 0.024, 0}, 0.013}},
                           .force = Point3{0, -side * 0.12, 0}});
  }
  return scene;
}

TEST(SelfContact, ASoftRingClosesOnItself) {
  const SelfTouch touch = run_judged(ring(true), 75);
  EXPECT_GT(touch.most, 2U);
  EXPECT_GT(touch.steps, 20);
  EXPECT_GT(touch.impulse, 0);
}

/// The same ring passes through itself where it does not touch itself: the test above would see it.
TEST(SelfContact, IsOffForElasticBodiesUnlessAsked) {
  Simulator simulator(ring(false));
  double lowest_of_upper = 1;
  const auto start = simulator.surface_positions(0);
  for (int n = 0; n < 100; ++n) {
    simulator.step();
    EXPECT_EQ(simulator.record().contacts, 0);
    const auto now = simulator.surface_positions(0);
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (start[i][0] < -0.02 && start[i][1] > 0) {
        lowest_of_upper = std::min(lowest_of_upper, now[i][1]);
      }
    }
  }
  EXPECT_LT(lowest_of_upper, -1e-3);
}

}  // namespace
}  // namespace tetwarp::test

/// Nothing passes anything: fast bodies, moving walls, folding cloth. Judged by a test of all pairs
/// of triangles at the ends of steps and at 16 instants between.
#include <cmath>

#include "tests/simulate/touch_judge.hpp"

namespace tetwarp::test {
namespace {

struct Throw {
  double speed, youngs_modulus, time_step;
  double lowest = 0.9;  ///< place of a point above the plate [thicknesses]
};

/// A soft ball against a plate of two triangles, at up to ten diameters a step. Points that come
/// within half the thickness are contacts and end at the thickness; others may end between: of a
/// very soft ball that a single step flattens some do.
TEST(Throws, ASoftBallStaysAboveAPlate) {
  for (const Throw& of : {Throw{20, 1e5, 0.01}, Throw{100, 1e5, 0.01}, Throw{100, 1e4, 0.01, 0.5},
                          Throw{50, 1e6, 0.004}}) {
    Body ball = elastic_ball("ball", 0.05, {0.03, 0.01, 0.3});
    ball.material.youngs_modulus = of.youngs_modulus;
    ball.velocity = {0.1 * of.speed, 0, -of.speed};
    Scene scene = scene_of({ball}, of.time_step);
    scene.obstacles = {plate_at(0, 20)};
    scene.thickness = 3e-4;
    scene.contact.material.friction = 0.3;
    Simulator simulator(scene);
    Judge judge(simulator);
    double low = 1;
    std::int64_t clamped = 0;
    for (int n = 0; n < 12; ++n) {
      simulator.step();
      judge.expect_apart();
      low = std::min(low, lowest(simulator.surface_positions(0)));
      clamped += simulator.record().clamped_islands;
    }
    EXPECT_GE(low, of.lowest * 3e-4) << of.speed << " m/s, " << of.youngs_modulus << " Pa";
    EXPECT_LE(low, 0.02);
    EXPECT_EQ(clamped, 0);
    EXPECT_EQ(simulator.record().inverted, 0);
  }
}

/// A body on a floor and a lid at a height, which goes down by `way` within 0.1 s.
Scene under_a_lid(const Body& body, double height, double way) {
  Body lid = elastic_box("lid", {0.1, 0.1, 0.005}, {1, 1, 1});
  lid.kind = BodyKind::scripted;
  lid.pose.position = {0, 0, height};
  lid.motion = Path{{0, Point3{0, 0, 0}}, {0.1, Point3{0, 0, -way}}};
  Scene scene = scene_of({body, lid}, 0.005);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  return scene;
}

/// A rigid box between walls cannot give way: the walls end where the box is.
TEST(Squeezing, OfARigidBodyHoldsThePaths) {
  Simulator simulator(under_a_lid(rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0.06}), 0.13, 0.1));
  Judge judge(simulator);
  std::int64_t stalled = 0;
  for (int n = 0; n < 25; ++n) {
    ASSERT_TRUE(simulator.step());
    judge.expect_apart();
    stalled += simulator.record().stalled_scripts;
  }
  EXPECT_GT(stalled, 5);
  EXPECT_GE(lowest(simulator.surface_positions(0)), 0);
  EXPECT_GE(simulator.record().bodies[1].center[2], 0.105);
}

/// However a box lies between walls that close, contact does not throw it.
TEST(Squeezing, LeavesARigidBodySlow) {
  for (const double tilt : {1e-3, 0.6}) {
    Body box = rigid_box("box", {0.05, 0.04, 0.03}, {0, 0, 0.08});
    const double length = std::hypot(1, tilt, 0.3);
    box.pose.rotation = {1 / length, tilt / length, 0, 0.3 / length};
    Simulator simulator(under_a_lid(box, 0.17, 0.16));
    double fastest = 0;
    for (int n = 0; n < 25; ++n) {
      ASSERT_TRUE(simulator.step());
      fastest = std::max(fastest, norm(simulator.record().bodies[0].velocity));
    }
    EXPECT_LT(fastest, 20) << tilt;
  }
}

/// A moving obstacle takes a body with it.
TEST(Obstacles, PushBodies) {
  Obstacle wall = plate_at(0, 0.1);
  wall.geometry = Surface{{{0, -0.2, -0.2}, {0, 0.2, -0.2}, {0, 0.2, 0.2}, {0, -0.2, 0.2}},
                          {{0, 1, 2}, {0, 2, 3}}};
  wall.path = {{0, Point3{0, 0, 0}}, {0.5, Point3{0.5, 0, 0}}};
  Body ball = rigid_ball("ball", 0.05, {0.06, 0, 0});
  Body soft = elastic_box("soft", {0.03, 0.03, 0.03}, {1, 1, 1});
  soft.pose.position = {0.2, 0, 0};
  Scene scene = scene_of({ball, soft}, 0.01);
  scene.obstacles = {wall};
  scene.gravity = {0, 0, 0};
  scene.thickness = 1e-4;
  Simulator simulator(scene);
  Judge judge(simulator);
  for (int n = 0; n < 50; ++n) {
    simulator.step();
    judge.expect_apart();
  }
  const StepRecord& record = simulator.record();

  EXPECT_GE(record.bodies[0].center[0], 0.55);
  EXPECT_GE(record.bodies[0].velocity[0], 0.9);
  EXPECT_GT(record.bodies[1].center[0], 0.6);
  EXPECT_GT(record.energy.work, 0);
}

/// A cloth that falls over a bar onto the floor.
TEST(Cloth, FoldsWithoutPassingItself) {
  Body cloth = sheet_body("cloth", {0.4, 0.1}, {16, 4});
  cloth.pose.position = {-0.2, -0.05, 0.12};
  Obstacle bar;
  bar.name = "bar";
  bar.geometry = CapsuleObstacle{{-0.03, -0.2, 0.1}, {-0.03, 0.2, 0.1}, 0.01};
  Scene scene = scene_of({cloth}, 0.005);
  scene.obstacles = {bar, plane_at(0)};
  scene.thickness = 5e-4;
  scene.contact.material.friction = 0.2;
  scene.solver.linear_tolerance = 1e-6;
  Simulator simulator(scene);
  Judge judge(simulator);
  for (int n = 0; n < 120; ++n) {
    simulator.step();
    judge.expect_apart();
  }
  EXPECT_GT(simulator.record().contacts, 0);
}

/// Boxes around ways of 500 m hold everything else, so that all triangles would be pairs.
TEST(Throwing, TooFastForTheMemoryOfDetectionIsAnErrorThatNamesTheStep) {
  Body above = sheet_body("above", {1, 1}, {60, 60}), below = sheet_body("below", {1, 1}, {60, 60});
  above.pose.position = {0, 0, 1};
  above.velocity = {1e5, 1e5, -1e6};
  for (Body* const body : {&above, &below}) body->self = false;
  Scene scene = scene_of({above, below}, 0.005);
  scene.thickness = 1e-3;
  scene.solver.max_substeps = 2;
  Simulator simulator(scene);
  try {
    simulator.step();
    FAIL() << "expected an error";
  } catch (const std::runtime_error& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find("step 0: bodies[0] 'above' (the fastest, 1.00"), 0U) << text;
    EXPECT_NE(text.find(" m/s) in 2 parts: more than "), std::string::npos) << text;
    EXPECT_NE(text.find("; reduce time_step"), std::string::npos) << text;
  }
  EXPECT_EQ(simulator.time(), 0);
}

}  // namespace
}  // namespace tetwarp::test

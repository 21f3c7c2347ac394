/// Balances of forces, momentum, energy and counts of steps with contact.
#include <cmath>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Bodies of all kinds on a floor, a scripted and a driven body that push.
Scene busy() {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {2, 2, 2});
  soft.pose.position = {0, 0, 0.051};
  soft.driven = {
      {{HalfSpaceSelection{{-1, 0, 0}, 0.049}}, {{0, Point3{0, 0, 0}}, {1, Point3{0.4, 0, 0}}}}};
  Body block = rigid_box("block", {0.03, 0.03, 0.03}, {0.085, 0, 0.031});
  Body ball = rigid_ball("ball", 0.03, {0, 0, 0.14});
  Body held = elastic_box("held", {0.03, 0.03, 0.03}, {1, 1, 2});
  held.pose.position = {0.2, 0, 0.032};
  held.fixed = {HalfSpaceSelection{{0, 0, 1}, 0.06}};
  Body paddle;
  paddle.name = "paddle";
  paddle.kind = BodyKind::scripted;
  paddle.geometry = Shape{BoxShape{{0.01, 0.05, 0.03}}};
  paddle.lattice = Lattice{.cells = {{1, 1, 1}}};
  paddle.pose.position = {0.26, 0, 0.04};
  paddle.motion = Path{{0, Point3{0, 0, 0}}, {1, Point3{-0.3, 0, 0}}};
  Scene scene = scene_of({soft, block, ball, held, paddle}, 0.002);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.3;
  scene.solver.contact_tolerance = 1e-6;
  return scene;
}

TEST(TouchRecords, ForcesChangeTheMomentum) {
  Simulator simulator(busy());
  bool have_touched = false;
  for (int n = 0; n < 60; ++n) {
    const StepRecord before = simulator.record();
    ASSERT_TRUE(simulator.step());
    // The tolerance of the solve of contacts: A v = J^T r + b.
    expect_balance(simulator, before, 1e-5);
    const StepRecord& after = simulator.record();
    have_touched = have_touched || after.contacts > 0;
    Point3 sum{0, 0, 0};
    double size = 0;
    for (const BodyRecord& body : after.bodies) {
      sum = plus(sum, body.contact_force);
      size += norm(body.contact_force);
    }
    for (const Point3& force : after.obstacle_forces) sum = plus(sum, force);
    EXPECT_LE(norm(sum), 1e-13 * size);
  }
  EXPECT_TRUE(have_touched);
}

/// The scripts' work covers what the bodies gain: backward Euler loses energy.
TEST(TouchRecords, EnergyGrowsByNoMoreThanTheWork) {
  Simulator simulator(busy());
  const double start = simulator.record().energy.total();
  for (int n = 0; n < 100; ++n) {
    simulator.step();
    const SceneEnergy& energy = simulator.record().energy;
    EXPECT_LE(energy.total(), start + energy.work + 1e-4 * std::fabs(energy.work) + 1e-6);
  }
}

TEST(TouchRecords, PointsAddUpToTheForces) {
  Simulator simulator(busy());
  run(simulator, 30);
  const StepRecord& record = simulator.record();
  ASSERT_EQ(record.substeps, 1);
  ASSERT_EQ(static_cast<std::int64_t>(simulator.contacts().size()), record.contacts);
  std::vector<Point3> sums(simulator.scene().bodies.size() + 1, Point3{0, 0, 0});
  for (const ContactPoint& point : simulator.contacts()) {
    EXPECT_NEAR(norm(point.normal), 1, 1e-12);
    EXPECT_LT(std::fabs(point.gap), 0.01);
    EXPECT_TRUE(is_finite(point.position));
    sums[point.body_a] = plus(sums[point.body_a], point.impulse);
    sums[point.body_b] = minus(sums[point.body_b], point.impulse);
  }
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    const Point3 force = times(1 / simulator.scene().time_step, sums[b]);
    EXPECT_LE(norm(minus(force, record.bodies[b].contact_force)), 1e-9 + 1e-12 * norm(force));
  }
}

/// An elastic block that adheres from the start: energy and area of the bond.
TEST(TouchRecords, AdhesionHasAreaAndEnergy) {
  Body block = elastic_box("block", {0.05, 0.05, 0.05}, {2, 2, 2});
  block.pose.position = {0, 0, 0.05 + 1.00001e-4};
  block.contact =
      SurfaceContact{0, AdhesionMaterial{.stiffness = 1e6, .energy = 1, .initial_intensity = 1}};
  Scene scene = scene_of({block}, 0.002);
  scene.obstacles = {plane_at(0)};
  scene.obstacles[0].contact = block.contact;
  scene.thickness = 1e-4;
  scene.gravity = {0, 0, 0};
  Simulator simulator(scene);
  run(simulator, 5);
  const StepRecord& record = simulator.record();

  EXPECT_NEAR(record.adhered_area, 0.01, 1e-8);
  EXPECT_NEAR(record.energy.adhesion, -0.01, 1e-5);
}

/// A step in parts: forces are those of the whole step.
TEST(TouchRecords, PartsOfStepsAddUp) {
  Body top = rigid_box("top", {0.02, 0.03, 0.04}, {0, 0, 0.04011});
  top.angular_velocity = {0, 0, 200};
  Scene scene = scene_of({top}, 0.004);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.2;
  Simulator simulator(scene);
  for (int n = 0; n < 10; ++n) {
    const StepRecord before = simulator.record();
    simulator.step();
    EXPECT_GT(simulator.record().substeps, 1);
    EXPECT_GE(simulator.record().contact_passes, simulator.record().substeps);
    expect_balance(simulator, before, 1e-9);
  }
}

}  // namespace
}  // namespace tetwarp::test

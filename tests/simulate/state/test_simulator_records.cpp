#include <gtest/gtest.h>

#include <cmath>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Two elastic boxes, a chain of rigid bodies, a cloth, handles, loads, a script and fixed nodes.
Scene everything() {
  Body held = elastic_box("held", {0.1, 0.1, 0.2}, {2, 2, 4});
  held.fixed = {HalfSpaceSelection{{0, 0, -1}, 0.19}};
  Body driven = elastic_box("driven", {0.1, 0.1, 0.1}, {2, 2, 2});
  driven.pose.position = {1, 0, 0};
  driven.driven = {
      {{HalfSpaceSelection{{0, 0, 1}, 0.09}}, {{0, Point3{0, 0, 0}}, {1, Point3{0.1, 0, 0.2}}}}};
  Body cloth = sheet_body("cloth", {0.4, 0.4}, {4, 4});
  cloth.pose.position = {0, 1, 0};
  Body jaw;
  jaw.name = "jaw";
  jaw.kind = BodyKind::scripted;
  jaw.motion = Hinge{{2, 0, 0}, {0, 1, 0}, {{0, 0}, {1, 1}}};
  Scene scene = scene_of({held, driven, rigid_box("first", {0.1, 0.1, 0.1}, {0, 0, 0.5}),
                          rigid_box("second", {0.05, 0.1, 0.1}, {0.4, 0, 0.5}), cloth, jaw},
                         0.004);
  scene.bodies[3].angular_velocity = {1, 2, 3};
  scene.couplings = {
      {.a = "held",
       .b = "first",
       .select_a = {HalfSpaceSelection{{0, 0, 1}, 0.19}},
       .stiffness = 1e4,
       .damping = 3},
      {.a = "first", .b = "second", .points = {{0.2, 0, 0.5}, {0.2, 0, 0.6}}, .stiffness = 1e5},
      {.a = "second", .b = "jaw", .points = {{0.5, 0, 0.5}}, .stiffness = 1e3, .damping = 10}};
  scene.handles = {{.name = "pull",
                    .body = "cloth",
                    .select = {NodeSelection{{0, 1, 2, 3, 4}}},
                    .stiffness = 500,
                    .damping = 1,
                    .path = {{0, Point3{0, 0, 0}}, {0.1, Point3{0, 0, 0.1}}}}};
  scene.loads = {
      {.body = "driven", .select = {AllSelection{}}, .force = Point3{0, 3, 0}},
      {.body = "second", .select = {AllSelection{}}, .force = Point3{1, 0, 2}},
      {.body = "held", .select = {HalfSpaceSelection{{1, 0, 0}, 0.09}}, .pressure = 300}};
  return scene;
}

/// mass (v_{n+1} - v_n) / dt = mass g + all forces on the body.
TEST(StepRecord, ForcesChangeTheMomentum) {
  Simulator simulator(everything());
  StepRecord before = simulator.record();
  for (int n = 0; n < 25; ++n) {
    simulator.step();
    const StepRecord& after = simulator.record();
    for (std::size_t b = 0; b < after.bodies.size(); ++b) {
      const BodyRecord& body = after.bodies[b];
      const double mass = simulator.body(b).mass;
      Point3 sum = times(mass, simulator.scene().gravity);
      double size = norm(sum);
      for (const Point3& force : {body.contact_force, body.support_force, body.handle_force,
                                  body.coupling_force, body.load_force}) {
        sum = plus(sum, force);
        size += norm(force);
      }
      const Point3 change = times(mass / 0.004, minus(body.velocity, before.bodies[b].velocity));
      const bool is_scripted = simulator.body(b).kind == BodyKind::scripted;
      EXPECT_LT(norm(minus(is_scripted ? Point3{0, 0, 0} : change, sum)), 1e-9 * (1 + size)) << b;
    }
    before = after;
  }
}

/// Loads are shared out completely, and couplings act on both bodies.
TEST(StepRecord, ForcesAreThoseOfTheScene) {
  Simulator simulator(everything());
  simulator.step();
  const StepRecord& record = simulator.record();

  EXPECT_LT(distance_of(record.bodies[1].load_force, {0, 3, 0}), 1e-12);
  EXPECT_LT(distance_of(record.bodies[3].load_force, {1, 0, 2}), 1e-12);
  // 300 Pa on 0.2 x 0.4 m, against the normal +x.
  EXPECT_LT(distance_of(record.bodies[0].load_force, {-24, 0, 0}), 1e-3);
  Point3 sum{0, 0, 0};
  for (std::size_t b = 0; b < 6; ++b) sum = plus(sum, record.bodies[b].coupling_force);
  EXPECT_LT(norm(sum), 1e-9);
  EXPECT_LT(distance_of(record.coupling_forces[0], record.bodies[0].coupling_force), 1e-12);
  EXPECT_EQ(record.islands, 3);
}

/// Backward Euler dissipates: what scripts, anchors and loads put in is never exceeded.
TEST(StepRecord, EnergyGrowsByLessThanTheWork) {
  Scene scene = everything();
  scene.loads.pop_back();  // a pressure turns with its surface in steps
  Simulator simulator(scene);
  const double start = simulator.record().energy.total();
  double before = start, largest = 0;
  for (int n = 0; n < 100; ++n) {
    simulator.step();
    const SceneEnergy& energy = simulator.record().energy;
    const double now = energy.total() - energy.work;
    largest = std::max(largest, now - before);
    before = now;
  }
  EXPECT_LT(before, start);
  EXPECT_LT(largest, 1e-4 * std::abs(start));
}

/// A free body keeps its momenta, and falls by g.
TEST(StepRecord, FreeFlightKeepsMomenta) {
  Body body = elastic_box("body", {0.1, 0.2, 0.1}, {2, 3, 2});
  body.velocity = {1, 2, 3};
  body.angular_velocity = {0, 0, 2};
  Scene scene = scene_of({body}, 0.001);
  scene.gravity = {0, 0, 0};
  Simulator simulator(scene);
  const StepRecord start = simulator.record();
  run(simulator, 100);
  const StepRecord& end = simulator.record();

  const double mass = simulator.body(0).mass;
  EXPECT_LT(distance_of(start.momentum, times(mass, {1, 2, 3})), 1e-11 * mass);
  EXPECT_LT(distance_of(end.momentum, start.momentum), 1e-9 * mass);
  const double moment = mass / 3 * (0.01 + 0.04);
  EXPECT_NEAR(start.bodies[0].angular_momentum[2], 2 * moment, 1e-11);
  EXPECT_NEAR(end.bodies[0].angular_momentum[2], 2 * moment, 1e-4 * moment);
  EXPECT_NEAR(start.energy.kinetic, mass * 14 / 2 + 2 * moment, 1e-10 * mass);
  EXPECT_LE(end.energy.kinetic + end.energy.elastic, start.energy.kinetic);
  EXPECT_NEAR(end.bodies[0].center[1], 0.2, 1e-9);
}

/// The force of a handle on a settled body is its weight.
TEST(StepRecord, HandleCarriesTheWeight) {
  Body body = elastic_box("body", {0.1, 0.1, 0.1}, {2, 2, 2});
  body.damping = {20, 0.01};
  Scene scene = scene_of({body}, 0.02);
  scene.handles = {
      {.body = "body", .select = {HalfSpaceSelection{{0, 0, 1}, 0.09}}, .stiffness = 5e3}};
  Simulator simulator(scene);
  run(simulator, 600);
  const StepRecord& record = simulator.record();

  const double weight = simulator.body(0).mass * 9.81;
  EXPECT_NEAR(record.bodies[0].handle_force[2] / weight, 1, 1e-6);
  EXPECT_LT(std::abs(record.bodies[0].handle_force[0]), 1e-6 * weight);
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_simulator_emulated.cpp
/// What a Simulator on back end cuda copies between host and device; the emulated one counts bytes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include <tetwarp/simulate.hpp>
#include <tetwarp/warp.hpp>

#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {
/// An elastic beam held at its end, a rigid body tied to it, a free one that turns, and a handle.
/// Nothing touches.
Scene tied_bodies() {
  Body beam = elastic_box("beam", {0.3, 0.05, 0.05}, {12, 3, 3});
  beam.fixed = {HalfSpaceSelection{{-1, 0, 0}, 0.299}};
  Body weight = rigid_box("weight", {0.02, 0.03, 0.04}, {0.34, 0, 0});
  Body top = rigid_box("top", {0.02, 0.03, 0.04}, {0, 0, 1});
  top.angular_velocity = {3, 40, 2};
  Scene scene = scene_of({beam, weight, top}, 0.002);
  Coupling tie;
  tie.a = "weight";
  tie.b = "beam";
  tie.points = {{0.3, 0.04, 0}, {0.3, -0.04, 0.02}};
  tie.stiffness = 400;
  tie.damping = 0.5;
  scene.couplings = {tie};
  Handle hand;
  hand.name = "hand";
  hand.body = "beam";
  hand.select = {HalfSpaceSelection{{1, 0, 0}, 0.299}};
  hand.stiffness = 300;
  scene.handles = {hand};
  for (Body& body : scene.bodies) body.collide = false;
  return scene;
}

SimulateOptions on(Backend backend) {
  SimulateOptions options;
  options.backend = backend;
  options.threads = 1;
  return options;
}

void expect_near(const std::vector<Point3>& a, const std::vector<Point3>& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LE(distance_of(a[i], b[i]), tolerance);
}

void expect_equal_course(const Scene& scene, int steps) {
  Simulator cpu(scene, on(Backend::cpu)), cuda(scene, on(Backend::cuda));
  for (int n = 0; n < steps; ++n) {
    cpu.step();
    cuda.step();
  }
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    expect_near(cuda.node_positions(b), cpu.node_positions(b), 1e-11);
    expect_near(cuda.node_velocities(b), cpu.node_velocities(b), 1e-8);
  }
  const StepRecord &a = cuda.record(), &b = cpu.record();
  EXPECT_EQ(a.substeps, b.substeps);
  EXPECT_NEAR(a.energy.work, b.energy.work, 1e-9);
  EXPECT_NEAR(a.energy.total(), b.energy.total(), 1e-8);
  for (std::size_t k = 0; k < a.bodies.size(); ++k) {
    EXPECT_LE(distance_of(a.bodies[k].center, b.bodies[k].center), 1e-11);
    EXPECT_LE(distance_of(a.bodies[k].support_force, b.bodies[k].support_force), 1e-6);
    EXPECT_LE(distance_of(a.bodies[k].handle_force, b.bodies[k].handle_force), 1e-6);
    EXPECT_LE(distance_of(a.bodies[k].coupling_force, b.bodies[k].coupling_force), 1e-6);
    EXPECT_LE(distance_of(a.bodies[k].load_force, b.bodies[k].load_force), 1e-6);
  }
}

/// A step brings counts, the ends of solves and sums per body to the host, and sends nothing.
TEST(SimulatorEmulated, AStepCopiesNoArrays) {
  Simulator simulator(tied_bodies(), on(Backend::cuda));
  const std::size_t array = 3 * sizeof(double) * simulator.body(0).mesh.rest_positions.size();
  run(simulator, 2);
  take_copied();

  simulator.step();

  const simt::CopiedBytes copied = take_copied();
  EXPECT_EQ(copied.to_device, 0u);
  EXPECT_LE(copied.to_host, 512u);
  EXPECT_GE(array, 4000u);
}

TEST(SimulatorEmulated, StepsAllocateNothing) {
  Simulator simulator(tied_bodies(), on(Backend::cuda));
  run(simulator, 2);
  take_calls();

  run(simulator, 2);

  EXPECT_EQ(take_calls().count(DeviceCall::allocate), 0);
}

/// The largest spin that a step must resolve is found on the device.
TEST(SimulatorEmulated, SpinsOfBallsDivideNoSteps) {
  for (const Point3& radii : {Point3{0.1, 0.1, 0.1}, Point3{0.1, 0.1, 0.11}}) {
    Body ball = rigid_box("ball", {0.1, 0.1, 0.1}, {0, 0, 0});
    ball.geometry = Shape{EllipsoidShape{radii}};
    ball.angular_velocity = {0, 0, 150};
    Simulator simulator(scene_of({ball}, 0.01), on(Backend::cuda));
    simulator.step();
    EXPECT_EQ(simulator.record().substeps, radii[2] == 0.1 ? 1 : 4);
  }
}

/// The whole state is copied once, however much of it is asked for.
TEST(SimulatorEmulated, TheStateIsCopiedWhenItIsReadFirst) {
  Simulator simulator(tied_bodies(), on(Backend::cuda));
  run(simulator, 2);
  take_copied();

  simulator.record();
  const std::size_t first = take_copied().to_host;
  simulator.node_positions(0);
  simulator.node_velocities(1);
  simulator.surface_positions(2);
  simulator.cell_stresses(0);
  simulator.cell_jacobians(0);
  simulator.checkpoint();

  EXPECT_GT(first, 8000u);
  EXPECT_EQ(take_copied().to_host, 0u);
}

/// Positions of a script cross as they change, but no others do.
TEST(SimulatorEmulated, ScriptsSendTheirOwnNodesOnly) {
  Scene scene = tied_bodies();
  Body driven = elastic_box("driven", {0.02, 0.02, 0.02}, {1, 1, 1});
  driven.kind = BodyKind::scripted;
  driven.pose.position = {0, 0, 2};
  driven.motion = Path{{0, Point3{0, 0, 0}}, {1, Point3{0.3, 0, 0}, {0, 0, 1}}};
  driven.collide = false;
  scene.bodies.push_back(driven);
  Simulator simulator(scene, on(Backend::cuda));
  const std::size_t nodes = simulator.body(3).mesh.rest_positions.size();
  run(simulator, 2);
  take_copied();

  simulator.step();

  EXPECT_LE(take_copied().to_device, (nodes + 2) * 3 * sizeof(double));
  expect_equal_course(scene, 5);
}

TEST(SimulatorEmulated, StepsAsTheCpuDoes) {
  Scene scene = tied_bodies();
  expect_equal_course(scene, 10);
  Load push;
  push.body = "weight";
  push.select = {HalfSpaceSelection{{1, 0, 0}, 0.0199}};
  push.force = Point3{0, 2, 1};
  Load pressure;
  pressure.body = "beam";
  pressure.select = {HalfSpaceSelection{{0, 0, 1}, 0.0499}};
  pressure.pressure = 300;
  scene.loads = {push, pressure};
  expect_equal_course(scene, 10);
}

/// A rigid body that turns too far divides the step, which is undone and made anew on the device.
TEST(SimulatorEmulated, DividedStepsAreMadeAnewOnTheDevice) {
  Scene scene = tied_bodies();
  scene.bodies[2].angular_velocity = {30, 400, 20};
  Load twist;
  twist.body = "weight";
  twist.select = {HalfSpaceSelection{{1, 0, 0}, 0.0199}};
  twist.force = Point3{0, 400, 0};
  scene.loads = {twist};
  expect_equal_course(scene, 4);
  Simulator simulator(scene, on(Backend::cuda));
  run(simulator, 4);
  EXPECT_GT(simulator.record().substeps, 1);
}

/// Bodies that touch at the start are pushed apart, from the touches of either back end.
TEST(SimulatorEmulated, BodiesThatTouchStartAsOnTheCpu) {
  Scene scene = scene_of({rigid_box("low", {0.1, 0.1, 0.05}, {0, 0, 0.05}),
                          elastic_box("high", {0.07, 0.08, 0.05}, {1, 1, 1}),
                          sheet_body("sheet", {0.1, 0.12}, {2, 2})},
                         0.005);
  for (Body& body : scene.bodies) body.surface = std::monostate{};
  scene.bodies[0].surface = std::int64_t{12};
  scene.bodies[1].pose.position = {0.01, 0.013, 0.15};
  std::get<Sheet>(scene.bodies[2].geometry).origin = {-0.05, -0.06, 0.2};
  scene.thickness = 1e-3;
  scene.obstacles = {{"floor", PlaneObstacle{}, {}, {}}};
  Simulator cpu(scene, on(Backend::cpu)), cuda(scene, on(Backend::cuda));
  EXPECT_NEAR(cpu.record().bodies[0].center[2], 0.051, 1e-5);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    expect_near(cpu.node_positions(b), cuda.node_positions(b), 1e-12);
  }
  EXPECT_GT(cuda.record().smallest_distance, 0.99e-3);
}

TEST(SimulatorEmulated, AnEndedStepHasNoEffect) {
  SimulateOptions options = on(Backend::cuda);
  bool goes_on = true;
  options.progress = [&](const StepProgress&) { return goes_on; };
  Simulator simulator(tied_bodies(), options), twin(tied_bodies(), on(Backend::cuda));
  run(simulator, 2);
  run(twin, 2);
  goes_on = false;
  EXPECT_FALSE(simulator.step());
  goes_on = true;
  EXPECT_EQ(simulator.checkpoint(), twin.checkpoint());

  simulator.step();
  twin.step();

  EXPECT_EQ(simulator.node_positions(0), twin.node_positions(0));
}

TEST(SimulatorEmulated, GoesOnFromACheckpointBitForBit) {
  Simulator whole(tied_bodies(), on(Backend::cuda)), resumed(tied_bodies(), on(Backend::cuda));
  run(whole, 3);
  resumed.restore(whole.checkpoint());
  run(whole, 3);
  run(resumed, 3);

  EXPECT_EQ(resumed.checkpoint(), whole.checkpoint());
}

/// A Warper on the same device reads positions where they are.
TEST(SimulatorEmulated, AWarperTakesPositionsFromTheDevice) {
  Simulator simulator(tied_bodies(), on(Backend::cuda));
  run(simulator, 3);
  Volume image;
  image.grid.dims = {26, 8, 8};
  image.grid.spacing = {0.025, 0.02, 0.02};
  image.grid.origin = {-0.3125, -0.07, -0.07};
  image.type = PixelType::uint8;
  image.data.resize(26 * 8 * 8);
  for (std::size_t v = 0; v < image.data.size(); ++v) image.data[v] = std::byte(v % 251);
  WarpOptions options;
  options.backend = Backend::cuda;
  Warper warper(image, simulator.body(0).mesh, options);
  warper.step(simulator.positions(0));
  take_copied();

  const PositionsView positions = simulator.positions(0);
  const Volume warped = warper.step(positions);

  EXPECT_EQ(positions.memory, Memory::device);
  EXPECT_EQ(take_copied().to_device, 0u);
  EXPECT_EQ(warped.data, warper.step(simulator.node_positions(0)).data);
}

}  // namespace
}  // namespace tetwarp::test

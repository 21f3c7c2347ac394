/// @file test_surfaces_emulated.cpp
/// Surfaces that a device moves: the motion of the host bit for bit, and what a step with contact
/// copies for detection.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "host/simulate/step/device_stepper.hpp"
#include "host/simulate/step/resident_surfaces.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/emulated/device_calls.hpp"
#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Bodies and obstacles of all kinds.
Scene all_kinds() {
  Body elastic = elastic_box("elastic", {0.1, 0.1, 0.1}, {2, 2, 2});
  elastic.surface = std::int64_t{100};
  Body sheet = sheet_body("sheet", {0.3, 0.2}, {30, 20});
  sheet.pose.position = {0, 0, 2};
  Body driven = elastic_box("driven", {0.1, 0.1, 0.1}, {1, 1, 1});
  driven.kind = BodyKind::scripted;
  driven.pose.position = {3, 0, 0};
  Scene scene = scene_of({elastic, rigid_box("box", {0.1, 0.2, 0.1}, {-1, 0, 0}), sheet,
                          rigid_capsule("pill", 0.1, 0.4, {0, -5, 0}), driven},
                         0.01);
  scene.obstacles = {{"floor", PlaneObstacle{{0, 1, 2}, {0, 0, -4}}, {}, {}},
                     {"bar",
                      CapsuleObstacle{{0, 0, -7}, {1, 0, -7}, 0.2},
                      {},
                      {{0, Point3{0, 0, 1}, {0.1, 0, 0}}}}};
  return scene;
}

/// Memory of the emulated device is memory of the host.
template <class T>
bool has_bits(View<const double> values, const std::vector<T>& expected) {
  const std::size_t bytes = expected.size() * sizeof(T);
  return static_cast<std::size_t>(values.size) * sizeof(double) == bytes &&
         (bytes == 0 || std::memcmp(values.data, expected.data(), bytes) == 0);
}

TEST(SurfacesEmulated, MoveAsOnTheHostBitForBit) {
  const TouchScene touch(all_kinds());
  const Model& model = touch.model;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-30, 30);
  std::vector<Point3> velocity(static_cast<std::size_t>(model.block_count()));
  for (Point3& v : velocity) v = {any(random), any(random), any(random)};
  const std::vector<double> fraction{1, 0.25, 0.5, 0.75, 1, 0.125, 0};
  const auto stepper = make_cuda_stepper(model, {});
  ResidentSurfaces& surfaces = stepper->on_device()->resident_surfaces();
  surfaces.begin(binding_of(touch.surfaces));

  for (const auto& fractions : {std::vector<double>{}, fraction}) {
    const SurfaceMotion expected =
        motion_of({touch.surfaces, model, model.start, velocity, 0.01, fractions});
    const ResidentMotion motion = surfaces.move(velocity, 0.01, fractions);
    EXPECT_TRUE(has_bits(motion.start, expected.start.vertices));
    EXPECT_TRUE(has_bits(motion.end, expected.end.vertices));
    EXPECT_TRUE(has_bits(motion.sagitta, expected.sagitta));
    EXPECT_TRUE(has_bits(motion.plane_start, expected.start.planes));
    EXPECT_TRUE(has_bits(motion.plane_end, expected.end.planes));
    EXPECT_TRUE(has_bits(motion.frames, expected.frames));
  }

  stepper->set_velocities(velocity);
  const ResidentMotion motion = surfaces.move({}, 0.01, fraction);
  const SurfaceMotion expected =
      motion_of({touch.surfaces, model, model.start, velocity, 0.01, fraction});
  EXPECT_TRUE(has_bits(motion.end, expected.end.vertices));
}

/// Velocities are sent where they have changed; places are not.
TEST(SurfacesEmulated, OnlyChangedVelocitiesAreSent) {
  const TouchScene touch(all_kinds());
  const auto stepper = make_cuda_stepper(touch.model, {});
  std::vector<Point3> velocity(static_cast<std::size_t>(touch.model.block_count()), {1, 2, 3});
  ResidentSurfaces& surfaces = stepper->on_device()->resident_surfaces();
  surfaces.begin(binding_of(touch.surfaces));
  surfaces.move(velocity, 0.01, {});
  take_copied();

  surfaces.begin(binding_of(touch.surfaces));
  surfaces.move(velocity, 0.01, {});
  surfaces.move({}, 0.01, {});
  EXPECT_EQ(take_copied().to_device, 0u);

  velocity[5] = {4, 5, 6};
  surfaces.move(velocity, 0.01, std::vector<double>(7, 0.5));
  EXPECT_EQ(take_copied().to_device, (3 + 7) * sizeof(double));
}

/// Four rows of four bricks of many vertices, at distances of `gap` above each other.
Scene brick_wall(double gap) {
  std::vector<Body> bricks;
  for (int k = 0; k < 16; ++k) {
    const int row = k / 4;
    bricks.push_back(
        rigid_box("brick" + std::to_string(k), {0.03, 0.02, 0.015},
                  {0.061 * (k % 4) + 0.03 * (row % 2), 0, 0.015 + gap + (0.03 + gap) * row}));
    bricks.back().surface = std::int64_t{1280};
  }
  Scene scene = scene_of(bricks, 0.004);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.contact.material.friction = 0.4;
  return scene;
}

struct StepCopies {
  simt::CopiedBytes bytes;
  DeviceCalls calls{""};
  std::int64_t contacts = 0, passes = 0;
  std::size_t vertices = 0;  ///< of surfaces
};

/// Of the last of some steps.
StepCopies copies_of(const Scene& scene, int steps) {
  Simulator simulator(scene, {.backend = Backend::cuda, .threads = 1});
  run(simulator, steps - 1);
  take_copied();
  take_calls();
  simulator.step();
  StepCopies copies;
  copies.bytes = take_copied();
  copies.calls = take_calls();
  copies.contacts = simulator.record().contacts;
  copies.passes = simulator.record().contact_passes;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    copies.vertices += simulator.surface_positions(b).size();
  }
  return copies;
}

/// What falls freely sends lists of bodies that may meet; one box per body comes to the host.
/// Places of the surfaces would be 56 bytes per vertex.
TEST(SurfacesEmulated, BodiesApartCopyNothingOfTheirSurfaces) {
  const StepCopies copies = copies_of(brick_wall(0.004), 4);
  EXPECT_EQ(copies.contacts, 0);
  EXPECT_GT(copies.vertices, 10000u);
  EXPECT_LE(copies.bytes.to_device, 4096u);
  EXPECT_LE(copies.bytes.to_host, 8192u);
  EXPECT_EQ(copies.calls.count(DeviceCall::allocate), 0);
}

/// Two detections and a check. Most bytes to the device are lists of the contact solver, most to
/// the host are the touches of vertices of the bricks.
TEST(SurfacesEmulated, AStepWithContactSendsNoPlaces) {
  const StepCopies copies = copies_of(brick_wall(3e-4), 12);
  EXPECT_GT(copies.contacts, 100);
  EXPECT_EQ(copies.passes, 2);
  EXPECT_LE(copies.bytes.to_device, 900u * static_cast<std::size_t>(copies.contacts));
  EXPECT_LE(copies.bytes.to_host, 100 * copies.vertices);
  EXPECT_EQ(copies.calls.count(DeviceCall::allocate), 0);
}

}  // namespace
}  // namespace tetwarp::test

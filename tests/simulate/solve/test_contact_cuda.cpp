/// @file test_contact_cuda.cpp
/// Steps with contact on back end cuda against those on cpu, on a device where there is one, and on
/// the emulated one: stepper, detector and the solvers of contacts are those of the device.
#include <memory>

#include <tetwarp/error.hpp>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {
Scene on_floor(std::vector<Body> bodies) {
  Scene scene = scene_of(std::move(bodies), 0.004);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.contact.material.friction = 0.4;
  scene.solver.contact_tolerance = 1e-11;
  return scene;
}

/// A box, a ball and a capsule that fall onto each other.
Scene rigid_pile() {
  Body low = rigid_box("low", {0.06, 0.06, 0.03}, {0, 0, 0.032});
  Body ball = rigid_ball("ball", 0.03, {0.01, 0.005, 0.1});
  Body high = rigid_capsule("high", 0.015, 0.06, {-0.02, 0, 0.185});
  ball.velocity = {0, 0, -1};
  high.velocity = {0, 0, -1};
  return on_floor({low, ball, high});
}

Scene soft_on_plane() {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {3, 3, 3});
  soft.pose.position = {0, 0, 0.055};
  soft.velocity = {0.3, 0, -0.5};
  return on_floor({soft});
}

Scene cloth_on_ball() {
  Body cloth = sheet_body("cloth", {0.2, 0.2}, {8, 8});
  cloth.pose.position = {-0.09, -0.11, 0.103};
  cloth.velocity = {0, 0, -0.5};
  Scene scene = on_floor({rigid_ball("ball", 0.05, {0, 0, 0.0503}), cloth});
  scene.solver.contact_tolerance = 1e-8;
  return scene;
}

/// The pile beside a soft box, and a tray that rises below both.
Scene mixed_on_tray() {
  Scene scene = rigid_pile();
  Body soft = elastic_box("soft", {0.02, 0.02, 0.02}, {2, 2, 2});
  soft.pose.position = {0.15, 0, 0.0203};
  scene.bodies.push_back(soft);
  Obstacle tray;
  tray.name = "tray";
  tray.geometry = Surface{{{-0.3, -0.3, 0}, {0.3, -0.3, 0}, {0.3, 0.3, 0}, {-0.3, 0.3, 0}},
                          {{0, 1, 2}, {0, 2, 3}}};
  tray.path = Path{{0, Point3{0, 0, 0}}, {1, Point3{0.1, 0, 0.05}}};
  scene.obstacles = {tray};
  return scene;
}

/// The pile under a falling cloth, beside the soft box, on the tray.
Scene cloth_over_tray() {
  Scene scene = mixed_on_tray();
  Body cloth = sheet_body("cloth", {0.12, 0.12}, {6, 6});
  cloth.pose.position = {0.1037, -0.0571, 0.0443};
  cloth.velocity = {0, 0, -0.5};
  scene.bodies.push_back(cloth);
  scene.solver.contact_tolerance = 1e-8;
  return scene;
}

/// A soft box on another one, whose upper nodes are driven upwards. Without friction, with which
/// solutions of so many contacts of few nodes are not unique.
Scene on_driven_nodes() {
  Body low = elastic_box("low", {0.03, 0.03, 0.02}, {3, 3, 2});
  low.pose.position = {0, 0, 0.021};
  DrivenNodes top;
  top.select = {HalfSpaceSelection{{0, 0, 1}, 0.015}};
  top.path = {{0, Point3{0, 0, 0}}, {1, Point3{0.1, 0, 0.2}}};
  low.driven = {top};
  Body high = elastic_box("high", {0.02, 0.02, 0.02}, {2, 2, 2});
  high.pose.position = {0.003, 0.002, 0.0615};
  high.velocity = {0, 0, -0.2};
  Scene scene = on_floor({low, high});
  scene.contact.material.friction = 0;
  return scene;
}

/// Two boxes that a coupling ties together, beside a free one.
Scene tied_boxes() {
  Scene scene = on_floor({rigid_box("a", {0.02, 0.02, 0.02}, {0, 0, 0.022}),
                          rigid_box("b", {0.02, 0.02, 0.02}, {0.05, 0, 0.022}),
                          rigid_box("c", {0.02, 0.02, 0.02}, {0.2, 0, 0.022})});
  for (Body& body : scene.bodies) body.velocity = {0.2, 0, -0.5};
  Coupling tie;
  tie.a = "a";
  tie.b = "b";
  tie.points = {{0.025, 0.01, 0.022}, {0.025, -0.01, 0.022}};
  tie.stiffness = 400;
  tie.damping = 0.5;
  scene.couplings = {tie};
  return scene;
}

void skip() {
  GTEST_SKIP() << "no usable device";
}

/// On back end cuda; null where no device can be used.
std::unique_ptr<Simulator> on_cuda(const Scene& scene) {
  try {
    return std::make_unique<Simulator>(scene, SimulateOptions{.backend = Backend::cuda});
  } catch (const CudaError&) {
    return nullptr;
  }
}

/// @returns the islands whose ways a step has shortened, of all steps
std::int64_t expect_parity(const Scene& scene, int steps, double tolerance) {
  const std::unique_ptr<Simulator> cuda = on_cuda(scene);
  if (cuda == nullptr) {
    skip();
    return 0;
  }
  Simulator cpu(scene, {.backend = Backend::cpu, .threads = 1});
  std::int64_t most_contacts = 0, clamped = 0;
  for (int n = 0; n < steps && !testing::Test::HasFailure(); ++n) {
    SCOPED_TRACE("step " + std::to_string(n));
    cpu.step();
    cuda->step();

    const StepRecord &a = cuda->record(), &b = cpu.record();
    EXPECT_EQ(a.contacts, b.contacts);
    EXPECT_EQ(a.contact_passes, b.contact_passes);
    EXPECT_EQ(a.islands, b.islands);
    EXPECT_EQ(a.clamped_islands, b.clamped_islands);
    clamped += b.clamped_islands;
    EXPECT_TRUE(a.converged && b.converged);
    EXPECT_NEAR(a.smallest_distance, b.smallest_distance, tolerance);
    const std::vector<Point3> places = places_of(*cuda), expected = places_of(cpu);
    double farthest = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      farthest = std::max(farthest, distance_of(places[i], expected[i]));
    }
    EXPECT_LE(farthest, tolerance);
    for (std::size_t body = 0; body < a.bodies.size(); ++body) {
      const Point3 &of_a = a.bodies[body].support_force, &of_b = b.bodies[body].support_force;
      EXPECT_LE(distance_of(of_a, of_b), 100 * tolerance * (1 + norm(of_b)));
    }
    most_contacts = std::max(most_contacts, b.contacts);
  }
  EXPECT_GT(most_contacts, 2);
  return clamped;
}

TEST(ContactCuda, ARigidPileFallsAsOnTheCpu) {
  expect_parity(rigid_pile(), 40, 1e-6);
}

TEST(ContactCuda, ARigidPileAndASoftBoxRideOnATrayAsOnTheCpu) {
  expect_parity(mixed_on_tray(), 10, 1e-6);
}

TEST(LongContactCuda, ARigidPileAndASoftBoxRideOnATrayAsOnTheCpu) {
  expect_parity(mixed_on_tray(), 30, 1e-6);
}

TEST(LongContactCuda, RigidAndSoftBodiesUnderAClothRideOnATrayAsOnTheCpu) {
  expect_parity(cloth_over_tray(), 4, 1e-6);
}

TEST(ContactCuda, TiedBoxesAndAFreeOneSlideAsOnTheCpu) {
  expect_parity(tied_boxes(), 25, 1e-6);
}

TEST(ContactCuda, ContactsGoOnFromACheckpointBitForBit) {
  const std::unique_ptr<Simulator> whole = on_cuda(mixed_on_tray());
  const std::unique_ptr<Simulator> resumed = on_cuda(mixed_on_tray());
  if (whole == nullptr) GTEST_SKIP() << "no usable device";
  run(*whole, 8);
  resumed->restore(whole->checkpoint());
  run(*whole, 2);
  run(*resumed, 2);

  EXPECT_GT(whole->record().contacts, 2);
  EXPECT_EQ(resumed->checkpoint(), whole->checkpoint());
}

TEST(ContactCuda, ASoftBoxSlidesOnAPlaneAsOnTheCpu) {
  expect_parity(soft_on_plane(), 8, 1e-6);
}

TEST(LongContactCuda, ASoftBoxSlidesOnAPlaneAsOnTheCpu) {
  expect_parity(soft_on_plane(), 25, 1e-6);
}

TEST(ContactCuda, ASoftBoxRidesOnDrivenNodesAsOnTheCpu) {
  expect_parity(on_driven_nodes(), 1, 1e-6);
}

/// With one detection per step the end check finds what the contacts of the step push together.
TEST(ContactCuda, WaysAreShortenedAsOnTheCpu) {
  Scene scene = rigid_pile();
  scene.solver.max_passes = 1;
  for (Body& body : scene.bodies) body.velocity = {1, 0, -4};
  const std::int64_t clamped = expect_parity(scene, 25, 1e-6);
  EXPECT_TRUE(clamped > 0 || testing::Test::IsSkipped());
}

TEST(ContactCuda, ClothLandsOnABallAsOnTheCpu) {
  expect_parity(cloth_on_ball(), 4, 1e-6);
}

TEST(LongContactCuda, ClothLandsOnABallAsOnTheCpu) {
  expect_parity(cloth_on_ball(), 8, 1e-6);
}

}  // namespace
}  // namespace tetwarp::test

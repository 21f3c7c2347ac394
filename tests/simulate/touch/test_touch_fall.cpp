/// Bodies that fall, rest and collide.
#include <tetwarp/surface.hpp>

#include "host/scene/shapes/shape_surface.hpp"
#include "tests/simulate/touch_run.hpp"
#include "tests/support/torn_mesh.hpp"

namespace tetwarp::test {
namespace {

Scene falling(Body body, double height) {
  body.pose.position = {0, 0, height};
  Scene scene = scene_of({std::move(body)}, 0.005);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.5;
  scene.solver.contact_tolerance = 1e-8;
  return scene;
}

/// The gap at rest is the thickness: the surfaces touch at that distance.
TEST(Falling, RigidSphereRestsAtTheThickness) {
  Simulator simulator(falling(rigid_ball("ball", 0.05, {}), 0.08));
  run(simulator, 100);
  const StepRecord& record = simulator.record();

  EXPECT_NEAR(record.bodies[0].center[2], 0.05 + 1e-4, 1e-9);
  EXPECT_NEAR(record.smallest_distance, 1e-4, 1e-9);
  EXPECT_LE(norm(record.bodies[0].velocity), 1e-9);
  EXPECT_EQ(record.contacts, 1);
  EXPECT_NEAR(record.bodies[0].contact_force[2], 9.81 * simulator.body(0).mass, 1e-9);
  EXPECT_NEAR(record.obstacle_forces[0][2], -9.81 * simulator.body(0).mass, 1e-9);
}

/// A plate under a box is pulled away within a step; the box then falls to the floor.
TEST(Falling, ABoxWhoseSupportIsPulledAwayIsStopped) {
  Scene scene = falling(rigid_box("box", {0.05, 0.05, 0.05}, {}), 0.0502);
  Body plate = rigid_box("plate", {0.05, 0.05, 2e-5}, {0, 0, 1.1e-4});
  plate.kind = BodyKind::scripted;
  plate.motion = Path{{0.05, Point3{0, 0, 0}}, {0.055, Point3{0.11, 0, 0}}};
  scene.bodies.push_back(plate);
  scene.thickness = 1e-5;
  scene.contact.material.friction = 0;
  Simulator simulator(scene);
  for (int n = 0; n < 20; ++n) {
    simulator.step();
    EXPECT_GT(lowest(simulator.surface_positions(0)), 0) << n;
    EXPECT_GT(simulator.record().smallest_distance, 0) << n;
  }
  EXPECT_NEAR(simulator.record().bodies[0].center[2], 0.05 + 1e-5, 1e-6);
}

TEST(Falling, RigidBoxRestsAtTheThickness) {
  Simulator simulator(falling(rigid_box("box", {0.05, 0.04, 0.03}, {}), 0.05));
  run(simulator, 100);
  const StepRecord& record = simulator.record();

  EXPECT_NEAR(record.bodies[0].center[2], 0.03 + 1e-4, 1e-7);
  EXPECT_NEAR(record.bodies[0].contact_force[2], 9.81 * simulator.body(0).mass,
              1e-4 * 9.81 * simulator.body(0).mass);
  EXPECT_LE(norm(record.bodies[0].velocity), 1e-5);
  EXPECT_LE(norm(record.bodies[0].angular_velocity), 1e-3);
}

/// Contacts name the vertices of rigid bodies that touch: here those of the lower face.
TEST(Falling, ContactsOfARigidBoxAreItsVertices) {
  Simulator simulator(falling(rigid_box("box", {0.05, 0.04, 0.03}, {}), 0.0302));
  run(simulator, 3);
  const std::vector<Point3> points = simulator.surface_positions(0);

  ASSERT_GE(simulator.contacts().size(), 3u);
  for (const ContactPoint& contact : simulator.contacts()) {
    const ContactPlace& place = contact.body_a == 0 ? contact.place_a : contact.place_b;
    ASSERT_GE(place.point[0], 0);
    EXPECT_EQ(place.weight[0], 1);
    EXPECT_LT(norm(minus(at(points, place.point[0]), contact.position)), 1e-4);
  }
}

TEST(Falling, ElasticBoxRestsAtTheThickness) {
  Simulator simulator(falling(elastic_box("box", {0.05, 0.05, 0.05}, {2, 2, 2}), 0.06));
  run(simulator, 300);
  const StepRecord& record = simulator.record();

  EXPECT_NEAR(lowest(simulator.surface_positions(0)), 1e-4, 2e-6);
  EXPECT_NEAR(record.bodies[0].contact_force[2], 9.81 * simulator.body(0).mass,
              1e-2 * 9.81 * simulator.body(0).mass);
  EXPECT_TRUE(record.converged);
}

/// A mesh whose parts meet with nodes of their own falls apart, but not through the floor.
TEST(Falling, EveryNodeOfATornMeshStaysAboveTheFloor) {
  const Mesh whole = make_lattice_mesh(make_shape_surface(BoxShape{{0.05, 0.05, 0.05}}, 12), 1);
  for (const std::uint32_t seed : {1, 2}) {
    Body body = elastic_box("torn", {1, 1, 1}, {1, 1, 1});
    body.geometry = torn(whole, seed);
    body.lattice.reset();
    Simulator simulator(falling(body, 0.055));
    for (int n = 0; n < 60; ++n) {
      simulator.step();
      EXPECT_GT(lowest(simulator.node_positions(0)), 1e-5) << "seed " << seed << ", step " << n;
    }
  }
}

TEST(Falling, ClothRestsOnAPlane) {
  Simulator simulator(falling(sheet_body("cloth", {0.2, 0.2}, {6, 6}), 0.02));
  run(simulator, 60);

  EXPECT_GE(lowest(simulator.surface_positions(0)), 0.9e-4);
  EXPECT_NEAR(simulator.record().bodies[0].center[2], 1e-4, 1e-5);
}

/// Two spheres without friction: the impulse along the line of centers, the tangential velocity
/// stays, and no momentum is lost.
TEST(Collisions, OfSpheresKeepMomentum) {
  Body first = rigid_ball("first", 0.05, {0, 0, 0});
  Body second = rigid_ball("second", 0.05, {0.2, 0.03, 0});
  first.velocity = {2, 0, 0.5};
  Scene scene = tight(scene_of({first, second}, 0.002));
  scene.gravity = {0, 0, 0};
  scene.thickness = 1e-4;
  Simulator simulator(scene);
  const StepRecord start = simulator.record();
  bool have_touched = false;
  for (int n = 0; n < 60; ++n) {
    const StepRecord before = simulator.record();
    simulator.step();
    expect_balance(simulator, before, 1e-12);
    have_touched = have_touched || simulator.record().contacts > 0;
    EXPECT_GT(simulator.record().smallest_distance, 1e-5);
  }
  const StepRecord& end = simulator.record();

  EXPECT_TRUE(have_touched);
  EXPECT_LE(norm(minus(end.momentum, start.momentum)), 1e-13 * norm(start.momentum));
  // The impulse acts along the normal where the spheres touch within the step: first order in dt.
  EXPECT_LE(norm(minus(end.angular_momentum, start.angular_momentum)),
            2e-3 * 0.2 * norm(start.momentum));
  EXPECT_GT(end.bodies[1].velocity[0], 0.5);
  EXPECT_LT(end.energy.kinetic, start.energy.kinetic);
}

/// Each box carries those above it.
TEST(Stacks, OfBoxesCarryTheirWeights) {
  std::vector<Body> boxes;
  boxes.reserve(3);
  for (int k = 0; k < 3; ++k) {
    boxes.push_back(
        rigid_box("box" + std::to_string(k), {0.05, 0.05, 0.05}, {0, 0, 0.051 + 0.101 * k}));
  }
  Scene scene = scene_of(boxes, 0.005);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 1e-4;
  scene.contact.material.friction = 0.5;
  scene.solver.contact_tolerance = 1e-8;
  Simulator simulator(scene);
  run(simulator, 200);
  const StepRecord& record = simulator.record();
  const double weight = 9.81 * simulator.body(0).mass;

  EXPECT_NEAR(record.obstacle_forces[0][2], -3 * weight, 1e-4 * weight);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(record.bodies[k].contact_force[2], weight, 1e-4 * weight);
    const double height = 0.05 + 1e-4 + (0.1 + 1e-4) * static_cast<double>(k);
    EXPECT_NEAR(record.bodies[k].center[2], height, 1e-6);
  }
  EXPECT_EQ(record.islands, 1);
}

/// Bodies that can meet nothing have no detector: nothing is detected.
TEST(Apart, ScenesWithoutPairsDetectNothing) {
  Scene scene =
      scene_of({rigid_ball("a", 0.05, {0, 0, 0}), rigid_ball("b", 0.05, {0.2, 0, 0})}, 0.005);
  scene.contact.pairs = {{.a = "a", .b = "b", .collide = false}};
  Simulator simulator(scene);
  run(simulator, 2);

  EXPECT_EQ(simulator.record().contact_passes, 0);
  EXPECT_EQ(simulator.record().seconds.detection, 0);
  EXPECT_TRUE(simulator.contacts().empty());
}

/// At rest the impulses of a step are those of the next, so that steps take few sweeps: the ball
/// touches all of the ring in every step, not other parts each time.
TEST(Falling, ABallInASoftRingComesToRest) {
  Body ring = elastic_ball("ring", 1, {0, 0, 0.00605});
  ring.geometry = Shape{TorusShape{0.014, 0.006}};
  ring.lattice = Lattice{.tets = 475};
  ring.surface = std::int64_t{1280};
  Scene scene = scene_of({ring, rigid_ball("ball", 0.01, {0.001, 0, 0.02})}, 0.008);
  scene.gravity = {0, 0, -9.81};
  scene.thickness = 5e-5;
  scene.obstacles = {plane_at(0)};
  Simulator simulator(scene);
  run(simulator, 150);
  std::int64_t sweeps = 0;
  for (int step = 0; step < 20; ++step) {
    simulator.step();
    sweeps += simulator.record().sweeps;
  }
  EXPECT_LE(sweeps, 60);
  EXPECT_LT(norm(simulator.record().bodies[1].velocity), 1e-4);
}

}  // namespace
}  // namespace tetwarp::test

/// Bodies at rest sleep where the scene asks for it, stand still and wake when something reaches
/// them.
#include <cmath>
#include <variant>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Two boxes on a floor, an elastic one beside them, and a ball that comes from the side.
Scene stack(bool sleeping) {
  Body low = rigid_box("low", {0.05, 0.05, 0.05}, {0, 0, 0.0503});
  Body soft = elastic_box("soft", {0.03, 0.03, 0.03}, {1, 1, 1});
  soft.pose.position = {0, 0.3, 0.0303};
  Body top = rigid_box("top", {0.04, 0.04, 0.04}, {0, 0, 0.1407});
  Body ball = rigid_ball("ball", 0.03, {-4.75, 0, 0.14});
  ball.velocity = {3, 0, 0};
  Scene scene = scene_of({low, soft, top, ball}, 0.01);
  scene.gravity = {0, 0, -9.81};
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.solver.linear_tolerance = 1e-9;
  scene.contact.material.friction = 0.6;
  scene.solver.sleeping = sleeping;
  return scene;
}

/// The ball flies without weight: a load carries it.
Scene stack_and_flying_ball(bool sleeping) {
  Scene scene = stack(sleeping);
  const double mass = Simulator(scene).body(3).mass;
  scene.loads = {{.body = "ball", .select = {AllSelection{}}, .force = Point3{0, 0, 9.81 * mass}}};
  return scene;
}

TEST(Sleep, IsOffByDefault) {
  EXPECT_FALSE(Scene{}.solver.sleeping);
  Simulator simulator(stack(false));
  run(simulator, 100);
  EXPECT_EQ(simulator.record().sleeping, 0);
  EXPECT_GT(simulator.record().sweeps, 0);
}

/// The stack rests from about 0.3 s on, sleeps from 0.8 s on and is hit at 1.55 s. Until then it is
/// where it is without sleep, to a tenth of the thickness; afterwards, to 1 mm of 100: contacts are
/// solved to 1e-7, as velocities after the impact depend on its friction impulses.
TEST(Sleep, AStackSleepsUntilABallHitsIt) {
  Scene scenes[] = {stack_and_flying_ball(false), stack_and_flying_ball(true)};
  for (Scene& scene : scenes) scene.solver.contact_tolerance = 1e-7;
  Simulator awake(scenes[0]), asleep(scenes[1]);
  run(awake, 145);
  run(asleep, 145);
  ASSERT_EQ(asleep.record().sleeping, 2);  // the stack and the elastic box
  EXPECT_EQ(asleep.record().islands, 3);
  EXPECT_EQ(asleep.record().sweeps, 0);
  EXPECT_EQ(asleep.record().outer_iterations, 0);
  EXPECT_NEAR(static_cast<double>(asleep.record().contacts),
              static_cast<double>(awake.record().contacts), 4);
  EXPECT_EQ(static_cast<std::int64_t>(asleep.contacts().size()), asleep.record().contacts);
  for (std::size_t b = 0; b < 3; ++b) {
    EXPECT_LE(largest_distance(awake.surface_positions(b), asleep.surface_positions(b)), 2e-5) << b;
  }
  const auto before = asleep.surface_positions(1);
  const StepRecord before_step = asleep.record();
  asleep.step();
  EXPECT_EQ(asleep.surface_positions(1), before);
  expect_balance(asleep, before_step, 1e-3);
  EXPECT_LE(norm(minus(asleep.record().obstacle_forces[0], awake.record().obstacle_forces[0])),
            1e-3 * norm(awake.record().obstacle_forces[0]));
  awake.step();

  run(awake, 40);
  run(asleep, 40);
  EXPECT_EQ(asleep.record().sleeping, 1);
  EXPECT_GT(distance_of(asleep.record().bodies[2].center, before_step.bodies[2].center), 5e-3);
  for (std::size_t b = 0; b < 4; ++b) {
    EXPECT_LE(largest_distance(awake.surface_positions(b), asleep.surface_positions(b)), 1e-3) << b;
  }
}

TEST(Sleep, ACheckpointOfSleepGoesOnBitForBit) {
  const Scene scene = stack_and_flying_ball(true);
  Simulator first(scene);
  run(first, 140);
  ASSERT_EQ(first.record().sleeping, 2);
  const auto bytes = first.checkpoint();
  const StepRecord at_checkpoint = first.record();
  Simulator second(scene);
  second.restore(bytes);
  EXPECT_EQ(second.checkpoint(), bytes);
  EXPECT_EQ(second.record().sleeping, 2);
  EXPECT_EQ(second.record().contacts, at_checkpoint.contacts);
  EXPECT_EQ(second.record().bodies[1].contact_force, at_checkpoint.bodies[1].contact_force);
  run(first, 25);
  run(second, 25);
  ASSERT_EQ(first.record().sleeping, 1);
  EXPECT_EQ(places_of(first), places_of(second));
  EXPECT_EQ(first.checkpoint(), second.checkpoint());
}

/// Bytes of a checkpoint with sleeping bodies, changed or cut at random.
TEST(Sleep, GoesOnFromADamagedCheckpointOrRefusesIt) {
  Simulator simulator(stack_and_flying_ball(true));
  run(simulator, 100);
  ASSERT_GT(simulator.record().sleeping, 0);
  const auto bytes = simulator.checkpoint();
  std::mt19937 random(2);
  int refused = 0;
  for (int n = 0; n < 60; ++n) {
    try {
      simulator.restore(damaged(bytes, random));
      simulator.step();
    } catch (const std::exception&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 0);
}

/// The ball is not quite round and spins, so that steps have parts until after the stack sleeps.
TEST(Sleep, ImpulsesAreThoseOfTheStepWhateverItsParts) {
  Scene scene = stack_and_flying_ball(true);
  std::get<EllipsoidShape>(std::get<Shape>(scene.bodies[3].geometry)).radii[2] *= 1.1;
  scene.bodies[3].velocity = {0, 0, 0};
  scene.bodies[3].angular_velocity = {0, 0, 115};
  scene.bodies[3].damping.alpha = 1;
  Simulator simulator(scene);
  while (simulator.record().sleeping == 0) simulator.step();
  ASSERT_GT(simulator.record().substeps, 1);
  while (simulator.record().substeps > 1) simulator.step();
  ASSERT_GT(simulator.record().sleeping, 0);
  double sum = 0;
  for (const ContactPoint& contact : simulator.contacts()) {
    if (contact.body_a == 4) sum += contact.impulse[2];
    if (contact.body_b == 4) sum -= contact.impulse[2];
  }
  EXPECT_NEAR(sum, scene.time_step * simulator.record().obstacle_forces[0][2], 1e-9);
}

TEST(Sleep, EndsWhenTheSupportMoves) {
  Obstacle table = plate_at(0, 0.2);
  table.path = {{0, Point3{0, 0, 0}}, {1.2, Point3{0, 0, 0}}, {1.4, Point3{0, 0, -0.4}}};
  Scene scene = scene_of({rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0.05021})}, 0.005);
  scene.obstacles = {table};
  scene.thickness = 2e-4;
  scene.solver.sleeping = true;
  Simulator simulator(scene);
  run(simulator, 238);
  ASSERT_EQ(simulator.record().sleeping, 1);
  const double height = simulator.record().bodies[0].center[2];
  run(simulator, 22);
  EXPECT_EQ(simulator.record().sleeping, 0);
  EXPECT_LT(simulator.record().bodies[0].center[2], height - 0.03);
}

/// Bodies without contact: a beam that hangs still wakes with a load, with its handle, and with
/// what it is coupled to.
TEST(Sleep, EndsWithLoadsHandlesAndCouplings) {
  Body beam = elastic_box("beam", {0.1, 0.02, 0.02}, {4, 1, 1});
  beam.fixed = {HalfSpaceSelection{{-1, 0, 0}, 0.099}};
  beam.damping.gamma = 0.05;
  Body weight = rigid_box("weight", {0.02, 0.02, 0.02}, {1, 0, 0});
  weight.damping.alpha = 20;
  Body hook = rigid_box("hook", {0.02, 0.02, 0.02}, {1, 0, 0.2});
  hook.kind = BodyKind::scripted;
  hook.lattice = Lattice{.cells = {{1, 1, 1}}};
  Scene scene = scene_of({beam, weight, hook}, 0.01);
  scene.solver.sleeping = true;
  scene.loads = {{.body = "beam",
                  .select = {HalfSpaceSelection{{1, 0, 0}, 0.099}},
                  .force = Point3{0, 0.02, 0},
                  .from = 2.995}};
  scene.handles = {{.name = "hand",
                    .body = "beam",
                    .select = {HalfSpaceSelection{{1, 0, 0}, 0.099}},
                    .stiffness = 1,
                    .path = {{0, Point3{0, 0, 0}}}}};
  scene.couplings = {
      {.a = "weight", .b = "hook", .points = {{1, 0, 0.1}}, .stiffness = 1e4, .damping = 10}};
  Simulator simulator(scene);
  run(simulator, 299);
  ASSERT_EQ(simulator.record().sleeping, 2);
  EXPECT_EQ(simulator.record().linear_iterations, 0);
  const auto before = simulator.checkpoint();
  simulator.step();
  EXPECT_EQ(simulator.record().sleeping, 1);  // the load
  EXPECT_GT(norm(simulator.record().bodies[0].velocity), 0);

  simulator.restore(before);
  simulator.move_script("hook", {0, 0, 1e-3}, {0, 0, 0});
  simulator.step();
  EXPECT_EQ(simulator.record().sleeping, 0);
  EXPECT_GT(norm(simulator.record().bodies[1].velocity), 0);

  Scene no_load = scene;
  no_load.loads.clear();
  Simulator by_hand(no_load);
  run(by_hand, 299);
  ASSERT_EQ(by_hand.record().sleeping, 2);
  by_hand.move_handle("hand", {0, 0, 0.01});
  by_hand.step();
  EXPECT_EQ(by_hand.record().sleeping, 1);
  EXPECT_GT(norm(by_hand.record().bodies[0].velocity), 0);
}

}  // namespace
}  // namespace tetwarp::test

/// What must not change steps with contact: threads, order, checkpoints, what is skipped.
#include <cmath>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// An elastic, a rigid, a cloth body and a scripted lid over a floor, with friction and adhesion.
Scene pile() {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {2, 2, 2});
  soft.pose.position = {0, 0, 0.052};
  soft.velocity = {0.1, 0, -0.2};
  Body block = rigid_box("block", {0.03, 0.03, 0.03}, {0.01, 0, 0.14});
  block.angular_velocity = {0.5, 1, 0};
  Body cloth = sheet_body("cloth", {0.2, 0.2}, {5, 5});
  cloth.pose.position = {-0.1, -0.1, 0.19};
  Body lid;
  lid.name = "lid";
  lid.kind = BodyKind::scripted;
  lid.geometry = Shape{BoxShape{{0.05, 0.05, 0.01}}};
  lid.lattice = Lattice{.cells = {{1, 1, 1}}};
  lid.pose.position = {0.25, 0, 0.02};
  lid.motion = Path{{0, Point3{0, 0, 0}}, {0.2, Point3{-0.2, 0, 0}}};
  Scene scene = scene_of({soft, block, cloth, lid}, 0.004);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.contact.material.friction = 0.4;
  scene.bodies[0].contact = SurfaceContact{0.4, AdhesionMaterial{.stiffness = 1e5,
                                                                 .energy = 0.1,
                                                                 .viscosity = 0.01,
                                                                 .bonding_rate = 1e-3,
                                                                 .saturation_pressure = 100}};
  scene.bodies[1].contact = scene.bodies[0].contact;
  return scene;
}

TEST(TouchState, AnyNumberOfThreadsGivesTheSameBits) {
  Simulator one(pile(), {.backend = Backend::cpu, .threads = 1});
  Simulator two(pile(), {.backend = Backend::cpu, .threads = 2});
  run(one, 40);
  run(two, 40);

  EXPECT_GT(one.record().contacts, 0);
  EXPECT_EQ(places_of(one), places_of(two));
  EXPECT_EQ(one.checkpoint(), two.checkpoint());
  EXPECT_EQ(one.record().smallest_distance, two.record().smallest_distance);
}

TEST(TouchState, ACheckpointInMidContactGoesOnBitForBit) {
  Simulator first(pile());
  run(first, 20);
  const auto bytes = first.checkpoint();
  const StepRecord at_checkpoint = first.record();
  const auto contacts = first.contacts();
  ASSERT_GT(at_checkpoint.contacts, 0);
  run(first, 20);

  Simulator second(pile());
  run(second, 3);
  second.restore(bytes);
  EXPECT_EQ(second.checkpoint(), bytes);
  EXPECT_EQ(second.record().contacts, at_checkpoint.contacts);
  EXPECT_EQ(second.record().energy.adhesion, at_checkpoint.energy.adhesion);
  EXPECT_EQ(second.record().bodies[0].contact_force, at_checkpoint.bodies[0].contact_force);
  ASSERT_EQ(second.contacts().size(), contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    EXPECT_EQ(second.contacts()[c].impulse, contacts[c].impulse);
  }
  run(second, 20);

  EXPECT_EQ(places_of(first), places_of(second));
  EXPECT_EQ(first.checkpoint(), second.checkpoint());
}

TEST(TouchState, ADamagedCheckpointIsRefusedOrHasContactsOfTheScene) {
  Simulator simulator(pile());
  run(simulator, 20);
  const auto bytes = simulator.checkpoint();
  std::mt19937 random(1);
  int refused = 0;
  for (int n = 0; n < 1000; ++n) {
    simulator.restore(bytes);
    try {
      simulator.restore(damaged(bytes, random));
    } catch (const std::invalid_argument&) {
      ++refused;
      ASSERT_EQ(simulator.checkpoint(), bytes);
    }
    for (const ContactPoint& contact : simulator.contacts()) {
      ASSERT_LT(std::max(contact.body_a, contact.body_b), 5U);
      for (const std::int32_t point : contact.place_a.point) ASSERT_LT(point, 1000);
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(TouchState, AnOlderCheckpointIsRefused) {
  Simulator simulator(pile());
  auto bytes = simulator.checkpoint();
  bytes[0] = std::byte{1};

  try {
    simulator.restore(bytes);
    FAIL() << "restored";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("another version"), std::string::npos);
  }
}

/// What changes results changes what a checkpoint belongs to.
TEST(TouchState, ACheckpointIsRefusedWhereContactIsSolvedOtherwise) {
  const auto bytes = Simulator(pile()).checkpoint();
  const std::vector<void (*)(Scene&)> changes{
      [](Scene& s) { s.solver.max_passes = 3; },
      [](Scene& s) { s.solver.max_substeps = 2; },
      [](Scene& s) { s.solver.contact_tolerance = 1e-5; },
      [](Scene& s) { s.solver.pyramid = true; },
      [](Scene& s) { s.solver.restrictive = true; },
      [](Scene& s) { s.solver.sleeping = true; },
      [](Scene& s) { s.thickness = 3e-4; },
      [](Scene& s) { s.contact.material.friction = 0.5; },
      [](Scene& s) { s.bodies[0].contact->adhesion->energy = 0.2; },
      [](Scene& s) { s.bodies[0].contact->adhesion->tangential_stiffness = 2e5; },
      [](Scene& s) { s.bodies[0].self = true; },
      [](Scene& s) { s.bodies[3].collide = false; },
      [](Scene& s) { s.contact.pairs = {{.a = "soft", .b = "block", .friction = 0.1}}; },
      [](Scene& s) { std::get<PlaneObstacle>(s.obstacles[0].geometry).point[2] = -0.01; },
  };
  for (std::size_t k = 0; k < changes.size(); ++k) {
    Scene scene = pile();
    changes[k](scene);
    EXPECT_THROW(Simulator(scene).restore(bytes), std::invalid_argument) << "change " << k;
  }
  EXPECT_THROW(Simulator(pile(), {.float32_solve = true}).restore(bytes), std::invalid_argument);
  EXPECT_THROW(Simulator(pile(), {.max_iterations = 7}).restore(bytes), std::invalid_argument);
  EXPECT_NO_THROW(Simulator(pile(), {.threads = 2}).restore(bytes));
}

/// The order of bodies changes sums by rounding only.
TEST(TouchState, AnotherOrderOfBodiesGivesTheSameMotion) {
  const auto scene_with = [](const std::vector<std::size_t>& order) {
    std::vector<Body> bodies;
    for (const std::size_t k : order) {
      const auto name = std::to_string(k);
      const double x = 0.09 * static_cast<double>(k);
      if (k % 2 == 0) {
        Body body = elastic_box(name, {0.03, 0.03, 0.03}, {1, 1, 1});
        body.pose.position = {x, 0, 0.0305};
        body.velocity = {0, 0, -0.5};
        bodies.push_back(body);
      } else {
        bodies.push_back(rigid_ball(name, 0.03, {x, 0, 0.05}));
        bodies.back().velocity = {0.3, 0, -1};
      }
    }
    Scene scene = tight(scene_of(bodies, 0.002));
    scene.obstacles = {plane_at(0)};
    scene.thickness = 1e-4;
    scene.contact.material.friction = 0.3;
    return scene;
  };
  const std::vector<std::size_t> order{0, 1, 2, 3}, other{2, 3, 1, 0};
  Simulator first(scene_with(order)), second(scene_with(other));
  run(first, 25);
  run(second, 25);

  ASSERT_GT(first.record().contacts, 0);
  for (std::size_t b = 0; b < order.size(); ++b) {
    const auto at =
        static_cast<std::size_t>(std::find(other.begin(), other.end(), b) - other.begin());
    const auto one = first.surface_positions(b), two = second.surface_positions(at);
    ASSERT_EQ(one.size(), two.size());
    for (std::size_t i = 0; i < one.size(); ++i) EXPECT_LE(distance_of(one[i], two[i]), 1e-12);
  }
}

/// What a callback ends has no effect.
TEST(TouchState, AStepThatIsEndedHasNoEffect) {
  bool goes_on = true;
  SimulateOptions options{.backend = Backend::cpu};
  options.progress = [&](const StepProgress&) { return goes_on; };
  Simulator simulator(pile(), options);
  run(simulator, 20);
  const auto before = simulator.checkpoint();
  goes_on = false;

  EXPECT_FALSE(simulator.step());
  EXPECT_EQ(simulator.checkpoint(), before);
}

}  // namespace
}  // namespace tetwarp::test

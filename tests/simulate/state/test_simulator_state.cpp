/// Checkpoints, cancelling, bad input, islands and the back end reference.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <string>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

Scene coupled() {
  Body held = elastic_box("held", {0.1, 0.1, 0.2}, {2, 2, 3});
  held.fixed = {HalfSpaceSelection{{0, 0, -1}, 0.19}};
  Body top = rigid_box("top", {0.1, 0.1, 0.1}, {0, 0, 0.4});
  top.angular_velocity = {1, 2, 3};
  Scene scene = scene_of({held, top, sheet_body("cloth", {0.3, 0.3}, {3, 3})}, 0.01);
  scene.bodies[2].pose.position = {1, 0, 0};
  scene.couplings = {{.a = "held",
                      .b = "top",
                      .select_a = {HalfSpaceSelection{{0, 0, 1}, 0.19}},
                      .stiffness = 1e4}};
  scene.handles = {{.name = "hand",
                    .body = "cloth",
                    .select = {NodeSelection{{0, 3}}},
                    .stiffness = 100,
                    .damping = 0.1,
                    .path = {{0, Point3{0, 0, 0}}, {0.2, Point3{0, 0, 0.1}}}}};
  return scene;
}

TEST(Checkpoint, GoesOnBitForBit) {
  Simulator first(coupled());
  run(first, 7);
  first.move_handle("hand", {0.1, 0, 0});
  run(first, 3);
  const auto bytes = first.checkpoint();
  const StepRecord at_checkpoint = first.record();
  run(first, 10);

  Simulator second(coupled());
  run(second, 2);
  second.restore(bytes);
  EXPECT_EQ(second.step_index(), 10);
  EXPECT_EQ(second.record().energy.work, at_checkpoint.energy.work);
  EXPECT_EQ(second.record().bodies[2].handle_force, at_checkpoint.bodies[2].handle_force);
  EXPECT_EQ(second.checkpoint(), bytes);
  run(second, 10);

  EXPECT_EQ(places_of(first), places_of(second));
  EXPECT_EQ(first.checkpoint(), second.checkpoint());
}

TEST(Checkpoint, RefusesOtherScenesAndDamagedBytes) {
  Simulator simulator(coupled());
  simulator.step();
  auto bytes = simulator.checkpoint();
  const auto before = places_of(simulator);
  Scene other = coupled();
  other.handles[0].path[1].time = 0.3;
  Simulator of_other(other);

  EXPECT_THROW(of_other.restore(bytes), std::invalid_argument);
  for (const std::size_t size : {std::size_t{0}, std::size_t{9}, bytes.size() - 1}) {
    EXPECT_THROW(simulator.restore({bytes.data(), size}), std::invalid_argument);
  }
  bytes.push_back(std::byte{0});
  EXPECT_THROW(simulator.restore(bytes), std::invalid_argument);
  bytes.pop_back();
  for (std::size_t place = 0; place < bytes.size(); place += 97) {
    bytes[place] ^= std::byte{4};
    EXPECT_THROW(simulator.restore(bytes), std::invalid_argument) << place;
    bytes[place] ^= std::byte{4};
  }
  EXPECT_EQ(places_of(simulator), before);
}

/// What loads and paths act on is in no list of the model.
TEST(Checkpoint, RefusesLoadsAndPathsOfOtherNodes) {
  Scene scene = coupled();
  scene.loads = {{.body = "top", .select = {AllSelection{}}, .force = Point3{0, 0, 1}}};
  scene.bodies[0].fixed = {};
  scene.bodies[0].driven = {{{NodeSelection{{0, 1}}}, {{0, Point3{0, 0, 0}}}},
                            {{NodeSelection{{2, 3}}}, {{0, Point3{0, 0, 0.1}}}}};
  const auto bytes = Simulator(scene).checkpoint();
  Scene on_cloth = scene, on_nodes = scene, exchanged = scene;
  on_cloth.loads[0].body = "cloth";
  on_nodes.loads[0].body = "held";
  on_nodes.loads[0].select = {NodeSelection{{5}}};
  std::swap(exchanged.bodies[0].driven[0].select, exchanged.bodies[0].driven[1].select);

  EXPECT_NO_THROW(Simulator(scene).restore(bytes));
  for (const Scene& other : {on_cloth, on_nodes, exchanged}) {
    EXPECT_THROW(Simulator(other).restore(bytes), std::invalid_argument);
  }
}

TEST(Simulator, HasTheSameBitsForAnyNumberOfThreads) {
  Simulator one(coupled(), {.threads = 1}), three(coupled(), {.threads = 3});
  run(one, 10);
  run(three, 10);

  EXPECT_EQ(places_of(one), places_of(three));
  EXPECT_EQ(one.record().energy.total(), three.record().energy.total());
}

TEST(Simulator, CancelledStepHasNoEffect) {
  bool goes_on = true;
  Simulator simulator(coupled(), {.progress = [&](const StepProgress&) { return goes_on; }});
  run(simulator, 3);
  const auto before = simulator.checkpoint();
  goes_on = false;
  EXPECT_FALSE(simulator.step());
  EXPECT_EQ(simulator.checkpoint(), before);
  EXPECT_EQ(simulator.step_index(), 3);
  goes_on = true;
  EXPECT_TRUE(simulator.step());
  Simulator other(coupled());
  run(other, 4);

  EXPECT_EQ(places_of(simulator), places_of(other));
}

TEST(Simulator, ThrowingProgressHasNoEffect) {
  bool throws = false;
  Simulator simulator(coupled(), {.progress = [&](const StepProgress&) {
                        if (throws) throw std::string("stop");
                        return true;
                      }});
  simulator.step();
  const auto before = simulator.checkpoint();
  throws = true;
  EXPECT_THROW(simulator.step(), std::string);
  EXPECT_EQ(simulator.checkpoint(), before);
}

/// The reference gets masses, springs and scripts from the scene by itself.
TEST(Simulator, BackEndReferenceAgrees) {
  Simulator cpu(coupled()), reference(coupled(), {.backend = Backend::reference});
  run(cpu, 15);
  run(reference, 15);

  EXPECT_EQ(reference.backend(), Backend::reference);
  const auto a = places_of(cpu), b = places_of(reference);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_LT(distance_of(a[i], b[i]), 1e-9);
  EXPECT_NEAR(cpu.record().energy.total(), reference.record().energy.total(), 1e-8);
  EXPECT_LT(
      distance_of(cpu.record().bodies[0].support_force, reference.record().bodies[0].support_force),
      1e-6);
}

TEST(Simulator, StartHasNoForcesAndCounts) {
  Simulator simulator(coupled());
  const StepRecord& record = simulator.record();
  EXPECT_EQ(record.islands, 0);
  EXPECT_EQ(record.substeps, 0);
  EXPECT_EQ(record.time, 0);
  EXPECT_EQ(record.bodies[0].support_force, (Point3{0, 0, 0}));
  EXPECT_NEAR(record.bodies[1].angular_velocity[1], 2, 1e-14);
  EXPECT_NEAR(record.bodies[1].rotation[0], 1, 1e-14);
}

std::string error_of(const Scene& scene) {
  try {
    const Simulator simulator(scene);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "none";
}

TEST(Simulator, NamesWhatIsWrong) {
  Scene flat = scene_of({elastic_box("flat", {1, 1, 1}, {1, 1, 1})}, 0.01);
  flat.bodies[0].lattice.reset();
  flat.bodies[0].geometry = Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{{0, 1, 2, 3}}}};
  EXPECT_NE(error_of(flat).find("bodies[0]"), std::string::npos) << error_of(flat);

  Scene stiff = coupled();
  stiff.bodies[0].material.poissons_ratio = 0.5;
  EXPECT_NE(error_of(stiff).find("nu"), std::string::npos) << error_of(stiff);

  Scene far = coupled();
  far.couplings[0].within = 1e-9;
  EXPECT_NE(error_of(far).find("couplings[0].within"), std::string::npos) << error_of(far);

  Scene unknown = coupled();
  unknown.couplings[0].b = "nobody";
  EXPECT_NE(error_of(unknown).find("nobody"), std::string::npos) << error_of(unknown);

  Simulator simulator(coupled());
  EXPECT_THROW(simulator.body(3), std::invalid_argument);
  EXPECT_THROW(simulator.positions(9), std::invalid_argument);
  for (const auto& text : {error_of(flat), error_of(stiff), error_of(far), error_of(unknown)}) {
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

/// Pieces of a mesh that nothing connects move on their own.
TEST(Simulator, TakesDisconnectedPieces) {
  Body pieces = elastic_box("pieces", {1, 1, 1}, {1, 1, 1});
  pieces.lattice.reset();
  pieces.geometry =
      Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {5, 0, 0}, {6, 0, 0}, {5, 1, 0}, {5, 0, 1}},
           {{{0, 1, 2, 3}}, {{4, 5, 6, 7}}}};
  pieces.fixed = {NodeSelection{{0}}};
  Simulator simulator(scene_of({pieces}, 0.01));
  run(simulator, 10);

  EXPECT_NEAR(simulator.node_positions(0)[4][2], -9.81 * 1e-4 * 55, 1e-12);
  EXPECT_EQ(simulator.node_positions(0)[0], (Point3{0, 0, 0}));
}

}  // namespace
}  // namespace tetwarp::test

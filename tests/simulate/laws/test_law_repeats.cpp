/// @file test_law_repeats.cpp
/// Steps with contact: the same bits for any number of threads, and after a checkpoint in
/// mid-contact.
#include <gtest/gtest.h>

#include <array>

#include <algorithm>

#include "host/scene/shapes/shape_surface.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A soft box that sticks to the floor, a rigid one on it that slides, a cloth that falls on both.
Scene mixed() {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.04}, {3, 3, 2});
  soft.pose.position = {0, 0, 0.0415};
  Body hard = rigid_box("hard", {0.03, 0.03, 0.02}, {0.01, 0, 0.1025});
  hard.velocity = {0.5, 0, 0};
  Body sheet = sheet_body("sheet", {0.3, 0.3}, {6, 6});
  std::get<Sheet>(sheet.geometry).origin = {-0.15, -0.15, 0.13};
  Scene scene = floor_scene({soft, hard, sheet}, 0.005, 0.3);
  scene.solver.contact_tolerance = 1e-4;
  scene.solver.linear_tolerance = 1e-6;
  scene.contact.material.adhesion = AdhesionMaterial{.stiffness = 1e6,
                                                     .energy = 1,
                                                     .viscosity = 0.05,
                                                     .bonding_rate = 0.1,
                                                     .saturation_pressure = 500};
  return scene;
}

void expect_equal_states(const Simulator& a, const Simulator& b) {
  for (std::size_t body = 0; body < 3; ++body) {
    EXPECT_EQ(a.surface_positions(body), b.surface_positions(body)) << body;
    EXPECT_EQ(a.node_velocities(body), b.node_velocities(body)) << body;
  }
}

TEST(Contact, HasTheSameBitsForAnyNumberOfThreads) {
  SimulateOptions options;
  options.threads = 1;
  Simulator one(mixed(), options);
  run(one, 12);
  EXPECT_GT(one.record().contacts, 20);
  EXPECT_GT(one.record().adhered_area, 0);
  for (const int threads : {3}) {
    options.threads = threads;
    Simulator many(mixed(), options);
    run(many, 12);
    expect_equal_states(one, many);
    EXPECT_EQ(one.record().energy.total(), many.record().energy.total());
    EXPECT_EQ(one.record().sweeps, many.record().sweeps);
  }
}

TEST(Contact, GoesOnBitForBitFromACheckpoint) {
  Simulator whole(mixed());
  run(whole, 30);
  const auto state = whole.checkpoint();
  EXPECT_GT(whole.record().contacts, 20);
  run(whole, 15);

  Simulator second(mixed());
  second.restore(state);
  EXPECT_EQ(second.step_index(), 30);
  run(second, 15);
  expect_equal_states(whole, second);
  EXPECT_EQ(whole.record().adhered_area, second.record().adhered_area);
  EXPECT_EQ(whole.record().contacts, second.record().contacts);
  EXPECT_EQ(whole.record().smallest_distance, second.record().smallest_distance);
}

/// Rotations, blocks and pairs that are left out change no bit.
TEST(Contact, SkipsWorkWithTheSameBits) {
  Simulator skipping(mixed());
  SimulateOptions options;
  options.expert.skip = {.rotations = false, .blocks = false, .pairs = false};
  Simulator complete(mixed(), options);
  run(skipping, 25);
  run(complete, 25);
  EXPECT_GT(skipping.record().contacts, 20);
  expect_equal_states(skipping, complete);
}

/// Contacts after 100 steps with and without what a switch leaves out; two bodies are at the same
/// places.
std::array<std::int64_t, 2> contacts_of(const Scene& scene, bool SimulateSkipOptions::*skips) {
  Simulator skipping(scene);
  SimulateOptions options;
  options.expert.skip.*skips = false;
  Simulator complete(scene, options);
  run(skipping, 100);
  run(complete, 100);
  for (std::size_t body = 0; body < 2; ++body) {
    EXPECT_LT(largest_distance(skipping.surface_positions(body), complete.surface_positions(body)),
              0.1 * skipping.thickness())
        << body;
  }
  return {skipping.record().contacts, complete.record().contacts};
}

/// What a soft ball on a soft box would hit if its contacts let go makes no contacts: fewer of them
/// hold it where all do.
TEST(Contact, SkipsWhatWouldBeHitWithoutContactsThatHold) {
  Body low = elastic_box("low", {0.05, 0.05, 0.02}, {6, 6, 3});
  low.pose.position = {0, 0, 0.0202};
  Scene scene =
      floor_scene({low, elastic_ball("ball", 0.03, 300, {0.003, 0.002, 0.0706})}, 0.005, 0.3);
  scene.bodies[0].material.youngs_modulus = scene.bodies[1].material.youngs_modulus = 2e4;
  scene.bodies[1].surface = make_shape_surface(EllipsoidShape{{0.03, 0.03, 0.03}}, 1280);
  scene.solver.contact_tolerance = 1e-4;
  const auto [skipping, complete] = contacts_of(scene, &SimulateSkipOptions::hits);
  EXPECT_LT(3 * skipping, 2 * complete);
}

/// Boxes lie on each other the same with pairs of the diagonals of their sides.
TEST(Contact, SkipsEdgesWithinFlatFaces) {
  const Scene scene = floor_scene({rigid_box("low", {0.05, 0.05, 0.05}, {0, 0, 0.0502}),
                                   rigid_box("high", {0.04, 0.04, 0.04}, {0.01, 0.005, 0.1404})},
                                  0.002, 0.5);
  const auto [skipping, complete] = contacts_of(scene, &SimulateSkipOptions::flat_edges);
  EXPECT_LE(skipping, complete);
}

/// Islands without contacts that are solved with the others change results by the tolerance of
/// contacts, 1e-4, and do not change themselves. Seven steps, which neither divides: parts of steps
/// integrate free bodies more accurately.
TEST(Contact, SkipsIslandsWithinTheTolerance) {
  Scene scene = mixed();
  scene.bodies[2] = elastic_box("free", {0.05, 0.05, 0.04}, {3, 3, 2});
  scene.bodies[2].pose.position = {0, 0, 1};
  scene.bodies[2].angular_velocity = {1, 2, 3};
  Simulator skipping(scene);
  SimulateOptions options;
  options.expert.skip.islands = false;
  Simulator complete(scene, options);
  run(skipping, 7);
  run(complete, 7);
  EXPECT_GT(skipping.record().contacts, 4);
  EXPECT_EQ(complete.record().substeps, 1);
  for (std::size_t body = 0; body < 3; ++body) {
    EXPECT_LT(largest_distance(skipping.surface_positions(body), complete.surface_positions(body)),
              body == 2 ? 1e-7 : 2e-5)
        << body;
  }
}

}  // namespace
}  // namespace tetwarp::test

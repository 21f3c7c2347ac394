/// @file test_added_handles.cpp
/// Handles that a running simulation gets.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// A block that stands fast, and a box that falls on it.
Scene block_and_box() {
  Body held = elastic_box("held", {0.1, 0.1, 0.2}, {2, 2, 3});
  held.fixed = {HalfSpaceSelection{{0, 0, -1}, 0.19}};
  Scene scene = scene_of({held, rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0.26})}, 0.005);
  scene.handles = {{.name = "own",
                    .body = "box",
                    .select = {AllSelection{}},
                    .stiffness = 5,
                    .path = {{0, Point3{0, 0, 0}}, {0.2, Point3{0.01, 0, 0}}}}};
  return scene;
}

PointHandle finger(const std::string& body, const Point3& center, double radius = 0) {
  return {.name = "finger", .body = body, .center = center, .radius = radius, .stiffness = 200};
}

TEST(AddedHandle, ForceIsStiffnessTimesDistanceUntilItLetsGo) {
  Simulator simulator(block_and_box());
  run(simulator, 5);
  const std::vector<Point3> before = simulator.node_positions(0);
  const std::size_t node = before.size() - 1;  // a corner of the upper side
  simulator.add_handle(finger("held", before[node]));
  simulator.move_handle("finger", {0.03, 0, 0.01});
  for (int n = 0; n < 6; ++n) {
    simulator.step();
    const Point3 anchor = plus(before[node], {0.03, 0, 0.01});
    const Point3 expected = times(200, minus(anchor, simulator.node_positions(0)[node]));
    EXPECT_GT(norm(expected), 1);
    EXPECT_LT(distance_of(simulator.record().bodies[0].handle_force, expected),
              1e-5 * norm(expected));
  }
  simulator.release_handle("finger");
  simulator.step();
  EXPECT_EQ(simulator.record().bodies[0].handle_force, (Point3{0, 0, 0}));
}

/// Without a move nothing is pulled, and a body moves as without the handle.
TEST(AddedHandle, StartsWithoutForce) {
  Scene scene = scene_of({elastic_box("held", {0.1, 0.1, 0.2}, {2, 2, 3})}, 0.005);
  scene.gravity = {0, 0, 0};
  Simulator simulator(scene);
  simulator.add_handle(finger("held", {0, 0, 0.2}, 0.11));
  run(simulator, 3);
  EXPECT_LT(norm(simulator.record().bodies[0].handle_force), 1e-9);
}

/// A rigid body turns about the point that is held, not about its nearest corner.
TEST(AddedHandle, HoldsARigidBodyAtThePoint) {
  Scene scene = scene_of({rigid_box("box", {0.05, 0.05, 0.05}, {0, 0, 0})}, 0.01);
  scene.bodies[0].damping.alpha = 5;
  Simulator simulator(scene);
  run(simulator, 3);
  const Point3 held = plus(simulator.record().bodies[0].center, {0.02, 0, 0.05});
  PointHandle handle = finger("box", held);
  handle.stiffness = 1e6;
  handle.damping = 10;
  simulator.add_handle(handle);
  run(simulator, 1500);
  const Point3 arm = minus(held, simulator.record().bodies[0].center);
  EXPECT_LT(std::hypot(arm[0], arm[1]), 1e-3);  // it hangs below the point
  EXPECT_NEAR(arm[2], std::hypot(0.02, 0.05), 1e-3);
}

TEST(AddedHandle, EqualsAHandleOfTheScene) {
  Scene scene = block_and_box();
  Simulator added(scene);
  added.add_handle(finger("held", {0, 0, 0.2}, 0.11));
  scene.handles.push_back({.name = "finger",
                           .body = "held",
                           .select = {SphereSelection{{0, 0, 0.2}, 0.11}},
                           .stiffness = 200});
  Simulator whole(scene);
  for (Simulator* simulator : {&added, &whole}) {
    simulator->move_handle("finger", {0.02, 0.01, 0});
    run(*simulator, 8);
  }
  EXPECT_EQ(places_of(added), places_of(whole));
  EXPECT_EQ(added.scene().handles.size(), 2u);
}

TEST(AddedHandle, GoesOnFromACheckpointBitForBit) {
  Simulator first(block_and_box());
  const auto at_start = first.checkpoint();
  run(first, 10);
  first.add_handle(finger("held", {0.1, 0.1, 0.2}, 0.12));
  first.move_handle("finger", {0.02, 0, 0});
  run(first, 4);
  first.add_handle({.name = "thumb", .body = "box", .center = {0, 0, 1}, .stiffness = 50});
  run(first, 2);
  const auto bytes = first.checkpoint();
  run(first, 6);

  Simulator second(block_and_box());
  second.restore(bytes);
  EXPECT_EQ(second.checkpoint(), bytes);
  run(second, 6);
  EXPECT_EQ(places_of(first), places_of(second));
  EXPECT_EQ(first.checkpoint(), second.checkpoint());

  first.restore(at_start);  // has no handle
  EXPECT_EQ(first.scene().handles.size(), 1u);
  EXPECT_EQ(first.checkpoint(), at_start);
}

TEST(AddedHandle, IsReplacedByOneOfItsName) {
  Simulator simulator(block_and_box());
  simulator.add_handle(finger("held", {0, 0, 0.2}));
  simulator.move_handle("finger", {0.02, 0, 0});
  run(simulator, 2);
  simulator.add_handle(finger("box", {0.05, 0.05, 0.31}));
  run(simulator, 1);
  EXPECT_EQ(simulator.scene().handles.size(), 2u);
  EXPECT_EQ(simulator.record().bodies[0].handle_force, (Point3{0, 0, 0}));
}

TEST(AddedHandle, RefusesWhatCannotPull) {
  Simulator simulator(block_and_box());
  const auto refuses = [&](PointHandle handle, const std::string& text) {
    try {
      simulator.add_handle(handle);
      ADD_FAILURE() << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  PointHandle handle = finger("held", {0, 0, 0});
  handle.stiffness = 0;
  refuses(handle, "handle.stiffness");
  handle = finger("nobody", {0, 0, 0});
  refuses(handle, "there is no body 'nobody'");
  handle = finger("held", {0, 0, 0});
  handle.name = "own";
  refuses(handle, "is a handle of the scene");
  handle.name = "two words";
  refuses(handle, "handle.name");
  handle = finger("held", {0, 0, 0}, -1);
  refuses(handle, "handle.radius");
  Simulator reference(block_and_box(), {.backend = Backend::reference});
  EXPECT_THROW(reference.add_handle(finger("held", {0, 0, 0})), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test

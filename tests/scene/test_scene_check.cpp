/// @file test_scene_check.cpp
/// check_scene() on scenes that are made in C++: what a scene file cannot hold, or cannot miss.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <tetwarp/make.hpp>
#include <tetwarp/scene.hpp>

#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Scene scene_of_one() {
  Scene scene;
  scene.time_step = 0.01;
  scene.duration = 1;
  Body body;
  body.name = "block";
  body.geometry = Shape{BoxShape{}};
  body.lattice.emplace().edge = 0.5;
  scene.bodies.push_back(body);
  return scene;
}

std::string problem_after(const std::function<void(Scene&, Body&)>& change) {
  Scene scene = scene_of_one();
  change(scene, scene.bodies[0]);
  return message_of([&] { check_scene(scene); });
}

TEST(CheckScene, TakesASceneOfOneBlock) {
  EXPECT_EQ(problem_after([](Scene&, Body&) {}), "");
}

TEST(CheckScene, RefusesNumbersThatAreNotFinite) {
  EXPECT_EQ(problem_after([](Scene& s, Body&) { s.time_step = nan; }),
            "time_step: is nan, expected a number above 0 (s)");
  EXPECT_EQ(problem_after([](Scene& s, Body&) { s.duration = infinity; }),
            "duration: is inf, expected a number from 0 (s)");
  EXPECT_EQ(problem_after([](Scene& s, Body&) { s.gravity[1] = nan; }),
            "gravity: is not finite, expected a number");
  EXPECT_EQ(problem_after([](Scene&, Body& b) { b.velocity[2] = infinity; }),
            "bodies[0].velocity: is not finite, expected a number");
  EXPECT_EQ(problem_after([](Scene&, Body& b) { b.pose.rotation[0] = nan; }),
            "bodies[0].pose.quaternion: is not finite, expected a number");
  EXPECT_EQ(problem_after([](Scene&, Body& b) { b.material.poissons_ratio = nan; }),
            "bodies[0].material.nu: is nan, expected more than -1 and less than 0.5, e.g. 0.4");
}

TEST(CheckScene, RefusesAPoseThatIsNoRotation) {
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.pose.rotation = {2, 0, 0, 0};
            }),
            "bodies[0].pose.quaternion: has length 2, expected 1");
}

TEST(CheckScene, RefusesMeshesWithBadIndices) {
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.kind = BodyKind::rigid;
              b.lattice.reset();
              b.geometry = Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}};
            }),
            "bodies[0].mesh: triangle 0 refers to point 3, expected 0 to 2");
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.kind = BodyKind::rigid;
              b.lattice.reset();
              b.geometry = Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 1}}};
            }),
            "bodies[0].mesh: triangle 0 has a point twice, remove it");
  EXPECT_TRUE(problem_after([](Scene&, Body& b) {
                b.lattice.reset();
                b.geometry = Mesh{{{0, 0, 0}}, {{0, 1, 2, 3}}};
              }).starts_with("bodies[0].mesh: "));
}

TEST(CheckScene, RefusesImagesWithoutTheirSamples) {
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              ImageGeometry image;
              image.volume.grid.dims = {2, 2, 2};
              b.geometry = image;
            }),
            "bodies[0].volume: has 0 bytes of samples, 32 belong to its grid");
  EXPECT_TRUE(problem_after([](Scene&, Body& b) {
                Grid grid;
                grid.dims = {2, 2, 2};
                b.geometry = ImageGeometry{make_volume(grid, PixelType::uint8, 3), 1};
              }).starts_with("bodies[0].volume: has 3 components, expected one"));
}

TEST(CheckScene, RefusesWhatAKindOfBodyCannotHave) {
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.motion = Path{{0, Point3{}, {}}};
            }),
            "bodies[0].path: is not for fem bodies, remove it or change the kind");
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.kind = BodyKind::scripted;
              b.velocity = {1, 0, 0};
            }),
            "bodies[0].velocity: is not for scripted bodies, remove it or change the kind");
  EXPECT_EQ(problem_after([](Scene&, Body& b) { b.kind = BodyKind::rigid; }),
            "bodies[0].lattice: is not for rigid bodies, remove it or change the kind");
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.kind = BodyKind::scripted;
              b.geometry = std::monostate{};
              b.lattice.reset();
              b.motion = Wave{};
            }),
            "bodies[0].wave: needs a geometry to bend; give one or a path");
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.transfer = {{1, {}}};
            }),
            "bodies[0].transfer: needs a volume; give a material instead");
}

TEST(CheckScene, RefusesActionsOnNothing) {
  EXPECT_EQ(problem_after([](Scene& s, Body&) { s.handles.emplace_back().body = "block"; }),
            "handles[0].select: is missing or empty, expected a selection, e.g. \"all\"");
  EXPECT_EQ(problem_after([](Scene& s, Body&) { s.loads.emplace_back().body = "rock"; }),
            "loads[0].load: there is no body or obstacle 'rock', expected one of block");
  EXPECT_EQ(problem_after([](Scene& s, Body&) {
              Handle handle;
              handle.name = "h";
              handle.body = "block";
              handle.select = {AllSelection{}};
              handle.stiffness = 1;
              s.handles.assign(2, handle);
            }),
            "handles[1].name: 'h' names two of the handles; rename one");
  EXPECT_EQ(problem_after([](Scene& s, Body&) {
              Handle handle;
              handle.body = "block";
              handle.select = {AllSelection{}};
              handle.stiffness = 1;
              handle.path = {{0, Point3{0, 0, 0}}, {1, Point3{0, 0, 0}, {0, 0, 1}}};
              s.handles = {handle};
            }),
            "handles[0].path: turns, but anchors of handles only move; leave out the turns");
  EXPECT_EQ(problem_after([](Scene&, Body& b) {
              b.driven.push_back({{AllSelection{}}, {}});
            }),
            "bodies[0].driven[0].path: is missing or empty, expected [[t, x, y, z], ...]");
}
}  // namespace
}  // namespace tetwarp::test

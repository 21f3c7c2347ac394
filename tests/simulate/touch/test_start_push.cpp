/// @file test_start_push.cpp
/// Bodies that touch, or are nearer than the thickness, start, and are at the thickness after.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/start/prepare_start.hpp"
#include "host/simulate/start/start_check.hpp"
#include "tests/simulate/touch_run.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

constexpr double thickness = 1e-3;

/// A scene whose start has been prepared.
struct PushedStart {
  explicit PushedStart(const Scene& scene, bool untangle = false)
      : touch(scene), detector(make_cpu_detector(touch.surfaces.surfaces, {})) {
    before = touch.model.start;
    const StartParts parts{touch.scene, touch.geometry, touch.surfaces, *detector, 1};
    prepare_start(parts, untangle, touch.model);
  }
  /// Of all bodies at the start.
  double least_distance() {
    SurfacePlaces places;
    surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
    return detector->closest(places, 5 * thickness).distance;
  }
  Point3 way(std::size_t place) const {
    return minus(touch.model.start.position[place], before.position[place]);
  }
  double largest_way() const {
    double largest = 0;
    for (std::size_t n = 0; n < before.position.size(); ++n) {
      largest = std::max(largest, norm(way(n)));
    }
    return largest;
  }

  TouchScene touch;
  std::unique_ptr<Detector> detector;
  ModelState before;
};

Scene thick(std::vector<Body> bodies) {
  Scene scene = scene_of(std::move(bodies), 0.005);
  scene.thickness = thickness;
  scene.solver.linear_tolerance = 1e-6;
  return scene;
}

Obstacle mesh_floor() {
  Obstacle floor = plate_at(0, 0.5);
  floor.name = "floor";
  return floor;
}
Obstacle box_floor() {
  Obstacle floor;
  floor.name = "floor";
  Surface of = TouchScene(scene_of({rigid_box("box", {0.5, 0.5, 0.1}, {0, 0, 0})}, 0.01))
                   .geometry.bodies[0]
                   .surface;
  for (Point3& x : of.points) x[2] -= 0.1;
  floor.geometry = of;
  return floor;
}

/// Bodies of all kinds whose lowest points are at the height 0.
std::vector<Body> bodies_on_the_ground() {
  std::vector<Body> bodies{
      rigid_box("box", {0.1, 0.1, 0.05}, {0, 0, 0.05}), rigid_ball("ball", 0.1, {0, 0, 0.1}),
      rigid_capsule("rod", 0.05, 0.2, {0, 0, 0.15}),
      elastic_box("soft", {0.1, 0.1, 0.05}, {2, 2, 1}), sheet_body("sheet", {0.2, 0.2}, {3, 3})};
  bodies[3].pose.position = {0, 0, 0.05};
  return bodies;
}

TEST(StartPush, BodiesOfAllKindsStartAtEveryDistanceUpToTheThickness) {
  for (const Obstacle& floor : {plane_at(0), mesh_floor(), box_floor()}) {
    for (const Body& body : bodies_on_the_ground()) {
      for (const double gap : {0.0, -1e-17, 1e-12, 0.01, 0.4, 0.9999}) {
        SCOPED_TRACE(body.name + " at " + std::to_string(gap));
        Scene scene = thick({body});
        if (auto* sheet = std::get_if<Sheet>(&scene.bodies[0].geometry)) {
          sheet->origin = {-0.07, -0.11, 0};
        }
        scene.bodies[0].pose.position[2] += gap < 0 ? gap : gap * thickness;
        scene.obstacles = {floor};
        PushedStart start(scene);
        EXPECT_GE(start.least_distance(), (1 - 1e-6) * thickness);
        EXPECT_LE(start.largest_way(), (1.002 - gap) * thickness);
        // Straight away from the floor.
        EXPECT_LE(std::hypot(start.way(0)[0], start.way(0)[1]), 0.01 * thickness);
      }
    }
  }
}

/// Decimals that are equal only to rounding: nothing moves.
TEST(StartPush, BodiesAtTheThicknessStayWhereTheyAre) {
  for (const double height : {0.02, 0.3, 0.7, 5.1}) {
    for (const double shift : {0.0, -3e-17, -5e-13, 2e-12}) {
      Scene scene = thick({rigid_box("box", {0.1, 0.1, 0.01}, {0, 0, height + 0.01 + 1e-3})});
      scene.bodies[0].pose.position[2] += shift;
      scene.obstacles = {plane_at(height)};
      PushedStart start(scene);
      EXPECT_EQ(start.largest_way(), 0);
    }
  }
}

/// Of two free bodies the common center of mass stays; a stack is lifted one by one.
TEST(StartPush, BodiesGiveWayByTheirMasses) {
  Scene scene = thick({rigid_box("light", {0.1, 0.1, 0.1}, {0, 0, 0}),
                       rigid_box("heavy", {0.1, 0.1, 0.1}, {0.2, 0, 0})});
  scene.bodies[1].rigid.density = 3000;
  const PushedStart pair(scene);
  EXPECT_NEAR(pair.way(0)[0], -0.75 * thickness, 0.01 * thickness);
  EXPECT_NEAR(pair.way(1)[0], 0.25 * thickness, 0.01 * thickness);

  Scene stack = thick({});
  for (int b = 0; b < 6; ++b) {
    stack.bodies.push_back(
        rigid_box("box" + std::to_string(b), {0.1, 0.1, 0.05}, {0.01 * b, 0, 0.1 * b + 0.05}));
  }
  stack.obstacles = {plane_at(0)};
  PushedStart lifted(stack);
  for (std::size_t b = 0; b < 6; ++b) {
    const double ways = static_cast<double>(b + 1);
    EXPECT_NEAR(lifted.way(b)[2], ways * thickness, 0.01 * ways * thickness);
    EXPECT_LE(std::hypot(lifted.way(b)[0], lifted.way(b)[1]), 0.05 * thickness);
  }
}

/// Bricks without joints, as drawn: neighbors in a row and rows touch.
TEST(StartPush, AWallOfBricksStarts) {
  Scene scene = thick({});
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) {
      scene.bodies.push_back(rigid_box("brick" + std::to_string(3 * row + k), {0.1, 0.05, 0.03},
                                       {0.2 * k + 0.1 * (row % 2), 0, 0.06 * row + 0.03}));
    }
  }
  scene.obstacles = {plane_at(0)};
  PushedStart start(scene);
  EXPECT_GE(start.least_distance(), (1 - 1e-6) * thickness);
  EXPECT_LE(start.largest_way(), 5 * thickness);
}

TEST(StartPush, FarFromTheOriginRoundingIsNoIntersection) {
  for (const double far : {10.0, 1e4}) {
    Scene scene = thick({rigid_box("low", {0.1, 0.1, 0.1}, {far, 0.3 * far, 0.7}),
                         rigid_box("high", {0.1, 0.1, 0.1}, {far + 0.2, 0.3 * far, 0.7})});
    for (const double rounding : {0.0, 0.5e-9 * far, -0.5e-9 * far}) {
      scene.bodies[1].pose.position[0] = far + 0.2 + rounding;
      PushedStart start(scene);
      EXPECT_GE(start.least_distance(), 0.999 * thickness);
    }
    scene.bodies[1].pose.position[0] = far + 0.2 - 1e-2 * thickness - 4e-9 * far;
    EXPECT_NE(message_of([&] { PushedStart{scene}; }).find(" intersects "), std::string::npos);
  }
}

/// Elastic bodies and cloth that are held, or touch themselves, give way by single nodes.
TEST(StartPush, HeldBodiesAndFoldsGiveWayByNodes) {
  Scene scene = thick({elastic_box("held", {0.1, 0.1, 0.05}, {3, 3, 1})});
  scene.bodies[0].pose.position = {0, 0, 0.05};
  scene.bodies[0].fixed = {HalfSpaceSelection{{0, 0, 1}, 0.0999}};
  scene.obstacles = {mesh_floor()};
  PushedStart held(scene);
  EXPECT_GE(held.least_distance(), 0.999 * thickness);
  for (std::size_t n = 0; n < held.before.position.size(); ++n) {
    const bool is_fixed = held.touch.model.prescribed[n] != 0;
    EXPECT_EQ(norm(held.way(n)) > 0, !is_fixed) << n;
  }

  Body cloth = sheet_body("cloth", {1, 1}, {1, 1});
  // Two layers 1e-4 m apart that share an edge.
  cloth.geometry =
      Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0.9, 1e-4}}, {{{0, 1, 2}}, {{1, 0, 3}}}};
  PushedStart folded(thick({cloth}));
  EXPECT_GE(folded.least_distance(), 0.999 * thickness);
  EXPECT_LE(folded.largest_way(), thickness);
}

TEST(StartPush, CoupledBodiesMoveTogetherAndAnchorsFollow) {
  Scene scene = thick({rigid_box("low", {0.1, 0.1, 0.05}, {0, 0, 0.05}),
                       elastic_box("high", {0.1, 0.1, 0.05}, {2, 2, 1})});
  scene.bodies[1].pose.position = {0, 0, 0.3};
  scene.obstacles = {plane_at(0)};
  scene.couplings = {
      {.a = "low", .b = "high", .points = {{0, 0, 0.2}}, .within = 0.1, .stiffness = 1e5}};
  scene.handles = {{.body = "high", .select = {AllSelection{}}, .stiffness = 1}};
  const PushedStart start(scene);
  const Model& model = start.touch.model;
  const auto nodes_and_box = static_cast<std::size_t>(model.node_count + 1);
  for (std::size_t n = 0; n < nodes_and_box; ++n) {
    EXPECT_LE(norm(minus(start.way(n), {0, 0, thickness})), 0.01 * thickness);
  }
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    if (model.springs.handle[s] < 0) continue;
    EXPECT_EQ(position_of(model.springs.a[s], model.start, model.node_count),
              model.springs.b[s].local);
  }
}

/// Sheets of cloth that coincide have no sides; with a distance they do.
TEST(StartPush, SheetsThatCoincideIntersect) {
  Scene scene =
      thick({sheet_body("low", {0.2, 0.2}, {2, 2}), sheet_body("high", {0.3, 0.3}, {2, 2})});
  std::get<Sheet>(scene.bodies[1].geometry).origin = {-0.03, -0.07, 0};
  EXPECT_NE(message_of([&] { PushedStart{scene}; }).find("' intersects bodies[1] 'high'"),
            std::string::npos);
  std::get<Sheet>(scene.bodies[1].geometry).origin[2] = 0.1 * thickness;
  PushedStart start(scene);
  EXPECT_GE(start.least_distance(), (1 - 1e-6) * thickness);
}

/// The same body twice touches nowhere from outside.
TEST(StartPush, ABodyThatIsThereTwiceIntersects) {
  const Scene scene = thick({rigid_box("one", {0.1, 0.1, 0.1}, {0.3, 0, 0}),
                             rigid_box("two", {0.1, 0.1, 0.1}, {0.3, 0, 0})});
  EXPECT_NE(message_of([&] { PushedStart{scene}; }), "");
}

/// A body that starts below the thickness moves as one that starts at it.
TEST(StartPush, NothingIsKicked) {
  for (const Point3& gravity : {Point3{0, 0, 0}, Point3{0, 0, -9.81}}) {
    for (const double dt : {1e-4, 0.005, 0.02}) {
      for (const Body& body : bodies_on_the_ground()) {
        SCOPED_TRACE(body.name + ", " + std::to_string(dt) + " s, " + std::to_string(gravity[2]));
        Scene scene = thick({body});
        scene.time_step = dt;
        scene.gravity = gravity;
        scene.obstacles = {plane_at(0)};
        Simulator pushed(scene);
        scene.obstacles = {plane_at(-1.001 * thickness)};
        Simulator apart(scene);
        for (int n = 0; n < 10; ++n) {
          ASSERT_TRUE(pushed.step());
          ASSERT_TRUE(apart.step());
          EXPECT_EQ(pushed.record().clamped_islands, 0);
          EXPECT_NEAR(pushed.record().bodies[0].velocity[2], apart.record().bodies[0].velocity[2],
                      1e-6);
          EXPECT_GT(pushed.record().smallest_distance, 0.9 * thickness);
        }
      }
    }
  }
}

/// A box that fills a slot has no room for the thickness: it starts, and does not intersect.
TEST(StartPush, ABodyWithoutRoomStarts) {
  Scene scene = thick({rigid_box("plug", {0.1, 0.1, 0.1}, {0, 0, 0.3})});
  scene.obstacles = {plane_at(-1), plane_at(-1)};
  scene.obstacles[0] = {"left", PlaneObstacle{{1, 0, 0}, {-0.1, 0, 0}}, {}, {}};
  scene.obstacles[1] = {"right", PlaneObstacle{{-1, 0, 0}, {0.1, 0, 0}}, {}, {}};
  Simulator simulator(scene);
  for (int n = 0; n < 5; ++n) ASSERT_TRUE(simulator.step());
  EXPECT_NEAR(simulator.record().bodies[0].center[0], 0, 1e-9);
}

}  // namespace
}  // namespace tetwarp::test

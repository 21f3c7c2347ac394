/// @file test_start_check.cpp
/// Bodies that cross, overlap or are inside one another at the start are errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host/base/box_tree.hpp"
#include "host/simulate/start/start_check.hpp"
#include "host/simulate/surfaces/near_pair.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/touch_scenes.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

using Kind = StartConflict::Kind;

std::vector<StartConflict> conflicts_of(const TouchScene& touch, int threads = 1) {
  const auto detector = make_cpu_detector(touch.surfaces.surfaces, {});
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, threads, places);
  return start_conflicts(touch.surfaces, places, *detector, threads);
}

bool is_near_start(const Scene& scene) {
  const TouchScene touch(scene);
  const auto detector = make_cpu_detector(touch.surfaces.surfaces, {});
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
  return check_start(touch.scene, touch.surfaces, places, *detector, 1);
}
std::string message_of_start(const Scene& scene) {
  return message_of([&] { is_near_start(scene); });
}

Scene two_boxes(const Point3& half, const Point3& other_half, const Point3& offset) {
  Scene scene =
      scene_of({rigid_box("low", half, {0, 0, 0}), rigid_box("high", other_half, offset)}, 0.01);
  scene.thickness = 1e-3;
  return scene;
}

const std::string remedy =
    "; move them apart, or set collide to false for the pair in contact.pairs";

TEST(StartCheck, BodiesThatTouchOrAreNearerThanTheThicknessAreNoError) {
  const Point3 half{0.1, 0.1, 0.1}, small{0.05, 0.05, 0.05};
  EXPECT_FALSE(is_near_start(two_boxes(half, small, {0, 0, 0.1511})));
  EXPECT_FALSE(is_near_start(two_boxes(half, small, {0, 0, 0.151 - 5e-11})));
  for (const double height : {0.1505, 0.15, 0.15 - 5e-11}) {
    EXPECT_TRUE(is_near_start(two_boxes(half, small, {0, 0, height})));
  }
  const std::string message = message_of_start(two_boxes(half, small, {0, 0, 0.15 - 1e-6}));
  EXPECT_EQ(message.find("bodies[0] 'low' intersects bodies[1] 'high' at the start, at ("), 0U)
      << message;
  EXPECT_NE(message.find(")" + remedy), std::string::npos) << message;
}

TEST(StartCheck, NamesWhatHelpsTheKindsOfBodies) {
  Scene scene = two_boxes({0.1, 0.1, 0.1}, {0.1, 0.1, 0.1}, {0, 0, 0.15});
  scene.bodies[0] = elastic_box("low", {0.1, 0.1, 0.1}, {1, 1, 1});
  EXPECT_NE(message_of_start(scene).find(
                "; move them apart, set cage_start of an elastic one, use the option untangle, or "
                "set collide to false for the pair in contact.pairs"),
            std::string::npos);
}

/// Two bars that cross far from all their corners: no vertex is near a face, no edge near an edge.
TEST(StartCheck, SurfacesThatCrossAreFound) {
  const auto conflicts =
      conflicts_of(TouchScene(two_boxes({1, 0.1, 0.1}, {0.11, 1, 0.11}, {0, 0, 0})));
  ASSERT_EQ(conflicts.size(), 1U);
  EXPECT_EQ(conflicts[0].kind, Kind::crosses);
  const std::string message =
      message_of_start(two_boxes({1, 0.1, 0.1}, {0.11, 1, 0.11}, {0, 0, 0}));
  EXPECT_NE(message.find("' intersects bodies["), std::string::npos) << message;
  EXPECT_NE(message.find(" at the start, at ("), std::string::npos) << message;
}

TEST(StartCheck, BodiesWithinOthersAreFound) {
  Scene scene = two_boxes({1, 1, 1}, {0.1, 0.1, 0.1}, {0.3, 0.4, 0.5});
  EXPECT_EQ(
      message_of_start(scene).find("bodies[1] 'high' is inside bodies[0] 'low' at the start, at ("),
      0U);
  scene.bodies[1] = rigid_ball("ball", 0.1, {0.3, 0, 0});
  EXPECT_EQ(message_of_start(scene),
            "bodies[1] 'ball' is inside bodies[0] 'low' at the start, at (0.3, 0, 0)" + remedy);
  scene.bodies[1].pose.position = {0, 5, 0};
  EXPECT_EQ(message_of_start(scene), "");
  // A mesh within a ball, and a ball below a plane, have negative distances.
  scene.bodies[1] = rigid_ball("ball", 9, {0, 0, 0});
  EXPECT_EQ(conflicts_of(TouchScene(scene))[0].kind, Kind::overlaps);
  EXPECT_LT(conflicts_of(TouchScene(scene))[0].distance, -7);
  scene.bodies[1] = rigid_ball("ball", 0.5, {3, 0, -5});
  scene.obstacles = {{"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -4}}, {}, {}}};
  const auto below = conflicts_of(TouchScene(scene));
  ASSERT_EQ(below.size(), 1U);
  EXPECT_NEAR(below[0].distance, -1.5, 1e-14);
  EXPECT_LT(norm(minus(below[0].place, {3, 0, -4.75})), 1e-12);
  EXPECT_EQ(below[0].bodies, (std::array<std::int32_t, 2>{1, 2}));
}

/// What is within the box of a body need not be within the body.
TEST(StartCheck, BodiesInHolesOfOthersAreApart) {
  Scene scene = scene_of({rigid_capsule("rod", 0.1, 3, {0, 0, 0}), rigid_ball("ring", 1, {0, 0, 0}),
                          rigid_ball("ball", 0.2, {0, 0, 0.5})},
                         0.01);
  scene.bodies[1].geometry = Shape{TorusShape{0.6, 0.2}};
  scene.bodies[2].pose.position = {0.35, 0, 0.4};
  EXPECT_EQ(message_of_start(scene), "");
}

TEST(StartCheck, PairsThatMayNotTouchAreLeftOut) {
  Scene scene = two_boxes({1, 1, 1}, {0.1, 0.1, 0.1}, {0, 0, 0});
  scene.contact.pairs = {{.a = "high", .b = "low", .collide = false}};
  EXPECT_EQ(message_of_start(scene), "");
  scene.contact.pairs.clear();
  scene.bodies[1].collide = false;
  EXPECT_EQ(message_of_start(scene), "");
  scene.bodies[1] = elastic_box("held", {0.1, 0.1, 0.1}, {1, 1, 1});
  scene.bodies[1].fixed = {AllSelection{}};
  EXPECT_NE(message_of_start(scene), "");
  scene.bodies[0] = scene.bodies[1];
  scene.bodies[0].name = "held_too";
  EXPECT_EQ(message_of_start(scene), "");
}

TEST(StartCheck, ClothThatCrossesItselfIsAnError) {
  Body cloth = sheet_body("cloth", {1, 1}, {1, 1});
  // Two triangles that share a corner.
  cloth.geometry = Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -0.1}, {0.2, 0.2, 0.1}},
                           {{{0, 1, 2}}, {{0, 3, 4}}}};
  Scene scene = scene_of({cloth}, 0.01);
  scene.thickness = 1e-3;
  EXPECT_EQ(message_of_start(scene).find("bodies[0] 'cloth' intersects itself at the start, at ("),
            0U)
      << message_of_start(scene);
  scene.bodies[0].self = false;
  EXPECT_EQ(message_of_start(scene), "");
}

/// The worst of many pairs is named, with their number.
TEST(StartCheck, NamesTheWorstOfManyPairs) {
  Scene scene = scene_of({}, 0.01);
  for (int b = 0; b < 5; ++b) {
    scene.bodies.push_back(
        rigid_ball("ball" + std::to_string(b), 0.5, {b == 0 ? 0.05 : 0.99 * b, 0, 0}));
  }
  const std::string message = message_of_start(scene);
  EXPECT_EQ(message.find("bodies[0] 'ball0' intersects bodies[1] 'ball1' at the start"), 0U)
      << message;
  EXPECT_NE(message.find(", by 0.06 m"), std::string::npos) << message;
  EXPECT_NE(message.find("(4 pairs of bodies in all)"), std::string::npos) << message;
}

TEST(StartCheck, ThreadsFindTheSame) {
  Scene scene = scene_of({}, 0.01);
  for (int b = 0; b < 12; ++b) {
    Body body = rigid_box("box" + std::to_string(b), {0.3, 0.2, 0.1}, {0.37 * b, 0.1 * b, 0});
    body.surface = std::int64_t{300};
    body.pose.rotation = {0.8, 0.6 * (b % 2), 0, 0.6 * ((b + 1) % 2)};
    scene.bodies.push_back(body);
  }
  const TouchScene touch(scene);
  const auto one = conflicts_of(touch, 1), many = conflicts_of(touch, 5);
  ASSERT_GT(one.size(), 5U);
  ASSERT_EQ(one.size(), many.size());
  for (std::size_t c = 0; c < one.size(); ++c) {
    EXPECT_EQ(one[c].bodies, many[c].bodies);
    EXPECT_EQ(one[c].place, many[c].place);
  }
}

TEST(NearPair, HoldsTheDistanceAndItsVertices) {
  Scene scene =
      scene_of({rigid_capsule("rod", 0.1, 2, {0, 0, 0}), rigid_capsule("bar", 0.2, 4, {1, 0, 0}),
                rigid_ball("ball", 0.25, {-1, 0, 0.5})},
               0.01);
  scene.bodies[1].pose.rotation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  const TouchScene touch(scene);
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
  const auto pair = [&](PairKind kind, std::int32_t a, std::int32_t b) {
    const NearPair near = near_pair({kind, a, b}, touch.surfaces.surfaces, places);
    Point3 apart{0, 0, 0};
    for (std::size_t i = 0; i < 4 && near.vertex[i] >= 0; ++i) {
      apart = plus(apart, times(near.weight[i], at(places.vertices, near.vertex[i])));
    }
    EXPECT_LT(norm(minus(unit(apart), near.normal)), 1e-14);
    return near;
  };
  const NearPair edges = pair(PairKind::edge_edge, 0, 1);
  EXPECT_NEAR(edges.distance, 0.7, 1e-14);
  EXPECT_LT(norm(minus(edges.normal, {-1, 0, 0})), 1e-14);
  EXPECT_LT(norm(minus(edges.place, {0.45, 0, 0})), 1e-14);
  EXPECT_EQ(edges.bodies, (std::array<std::int32_t, 2>{0, 1}));
  const NearPair ball = pair(PairKind::vertex_edge, 4, 0);
  EXPECT_NEAR(ball.distance, 0.65, 1e-14);
  EXPECT_LT(norm(minus(ball.place, {-0.425, 0, 0.5})), 1e-14);
  EXPECT_NEAR(pair(PairKind::vertex_vertex, 0, 4).distance, std::hypot(1, 1.5) - 0.35, 1e-14);
}

TEST(BoxTree, FindsWhatABruteSearchFinds) {
  const Surface surface =
      TouchScene(two_boxes({1, 1, 1}, {0.1, 0.1, 0.1}, {5, 0, 0})).geometry.bodies[0].surface;
  const BoxTree tree(boxes_of(surface.points, surface.triangles));
  for (double x = -1.2; x < 1.3; x += 0.37) {
    const Bounds box{{x, -0.2, -1.1}, {x + 0.3, 0.4, 0.1}};
    std::vector<std::int32_t> found, exact;
    tree.visit(box, [&](std::int32_t t) { found.push_back(t); });
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
      Bounds own;
      for (const std::int32_t corner : surface.triangles[t])
        own.include(at(surface.points, corner));
      bool is_near = true;
      for (std::size_t d = 0; d < 3; ++d) {
        is_near = is_near && own.low[d] <= box.high[d] && own.high[d] >= box.low[d];
      }
      if (is_near) exact.push_back(static_cast<std::int32_t>(t));
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, exact);
  }
  BoxTree({}).visit({{0, 0, 0}, {1, 1, 1}}, [](std::int32_t) { FAIL(); });
}

}  // namespace
}  // namespace tetwarp::test

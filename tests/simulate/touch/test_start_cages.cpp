/// @file test_start_cages.cpp
/// Bodies that overlap are brought apart at the start, by their cages or by shrinking them.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/start/prepare_start.hpp"
#include "host/simulate/start/start_check.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/touch_scenes.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp::test {
namespace {

/// A scene whose start has been prepared.
struct PreparedStart {
  PreparedStart(const Scene& scene, bool untangle, int threads = 1)
      : touch(scene), detector(make_cpu_detector(touch.surfaces.surfaces, {})) {
    before = touch.model.start.position;
    const StartParts parts{touch.scene, touch.geometry, touch.surfaces, *detector, threads};
    growth = prepare_start(parts, untangle, touch.model);
  }

  std::vector<StartConflict> conflicts() {
    SurfacePlaces places;
    surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
    return start_conflicts(touch.surfaces, places, *detector, 1);
  }
  /// The least volume of an element over that at rest.
  double least_volume() const {
    double least = 1;
    for (std::size_t t = 0; t < touch.model.tets.nodes.size(); ++t) {
      const auto [a, b, c, d] = touch.model.tets.nodes[t];
      const auto& x = touch.model.start.position;
      const double volume = tet_volume(at(x, a), at(x, b), at(x, c), at(x, d));
      least = std::min(least, volume / touch.model.tets.volume[t]);
    }
    return least;
  }
  double largest_way(std::size_t body) const {
    double largest = 0;
    for (std::int32_t n = touch.model.body_node[body]; n < touch.model.body_node[body + 1]; ++n) {
      largest = std::max(largest, distance_of(at(before, n), at(touch.model.start.position, n)));
    }
    return largest;
  }

  TouchScene touch;
  std::unique_ptr<Detector> detector;
  std::vector<Point3> before;
  RestGrowth growth;
};

Scene two_balls(double distance) {
  Scene scene =
      scene_of({soft_ball("left", {0, 0, 0}), soft_ball("right", {distance, 0.01, 0.02})}, 0.01);
  scene.thickness = 1e-3;
  return scene;
}

TEST(CageStart, BringsOverlappingBodiesApart) {
  for (const double distance : {0.19, 0.15, 0.11}) {
    Scene scene = two_balls(distance);
    scene.bodies[0].cage_start = scene.bodies[1].cage_start = true;
    PreparedStart start(scene, false);

    EXPECT_TRUE(start.conflicts().empty());
    EXPECT_TRUE(start.growth.empty());
    EXPECT_GT(start.least_volume(), 0.05) << distance;
    // Each gives way by half of the overlap and not much more.
    const double overlap = 0.2 - distance;
    for (const std::size_t body : {std::size_t{0}, std::size_t{1}}) {
      EXPECT_GT(start.largest_way(body), 0.1 * overlap) << distance;
      EXPECT_LT(start.largest_way(body), 1.2 * overlap + 0.003) << distance;
    }
  }
}

TEST(CageStart, LeavesBodiesThatAreApart) {
  Scene scene = two_balls(0.25);
  scene.bodies[0].cage_start = true;
  const PreparedStart start(scene, true);
  EXPECT_EQ(start.before, start.touch.model.start.position);
}

/// Only the body with a cage gives way; obstacles and rigid bodies stay.
TEST(CageStart, MovesTheBodyWithTheCageAlone) {
  Scene scene = two_balls(0.16);
  scene.bodies[0].cage_start = true;
  scene.bodies[1] = rigid_ball("right", 0.1, {0.16, 0, 0});
  scene.obstacles = {{"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -0.08}}, {}, {}}};
  scene.contact.pairs = {{.a = "right", .b = "floor", .collide = false}};
  PreparedStart start(scene, false);
  EXPECT_TRUE(start.conflicts().empty());
  EXPECT_GT(start.least_volume(), 0.05);
  EXPECT_GT(start.largest_way(0), 0.03);
  EXPECT_LT(start.largest_way(0), 0.08);
}

/// The middle of the body is within the other: it is scaled about a node that is outside.
TEST(CageStart, ComesOutOfABodyThatHoldsItsMiddle) {
  Scene scene = two_balls(0.15);
  scene.bodies[0].cage_start = true;
  scene.bodies[1] = rigid_box("block", {0.2, 0.2, 0.2}, {0.19, 0, 0});
  PreparedStart start(scene, false);
  EXPECT_TRUE(start.conflicts().empty());
  EXPECT_GT(start.least_volume(), 0.05);
}

TEST(CageStart, RestShapesStayAndAnchorsFollow) {
  Scene scene = two_balls(0.15);
  scene.bodies[0].cage_start = scene.bodies[1].cage_start = true;
  scene.handles = {{.body = "left", .select = {AllSelection{}}, .stiffness = 1}};
  const TouchScene before(scene);
  const PreparedStart start(scene, false);

  EXPECT_EQ(before.model.tets.gradient, start.touch.model.tets.gradient);
  EXPECT_EQ(before.surfaces.surfaces.vertex_area, start.touch.surfaces.surfaces.vertex_area);
  const Model& model = start.touch.model;
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    EXPECT_EQ(position_of(model.springs.a[s], model.start, model.node_count),
              model.springs.b[s].local);
  }
}

TEST(CageStart, ThreadsGiveTheSameBits) {
  Scene scene = two_balls(0.15);
  scene.bodies[0].cage_start = true;
  EXPECT_EQ(PreparedStart(scene, false, 1).touch.model.start.position,
            PreparedStart(scene, false, 4).touch.model.start.position);
}

TEST(CageStart, FailsWithAMessage) {
  Scene scene = two_balls(0.1);
  scene.bodies[0].cage_start = true;
  scene.bodies[1] = rigid_box("block", {0.2, 0.2, 0.2}, {0, 0, 0});
  EXPECT_EQ(message_of([&] { PreparedStart(scene, false); }),
            "bodies[0] 'left' and bodies[1] 'block' overlap so far that cage_start cannot bring "
            "them apart; move them apart");
  scene = two_balls(0.15);
  scene.bodies[0].cage_start = true;
  scene.bodies[0].driven = {{{NodeSelection{{0}}}, {{0, Point3{0, 0, 0}}}}};
  EXPECT_EQ(message_of([&] { PreparedStart(scene, false); }),
            "bodies[0] 'left': cage_start would move its driven nodes away from their path; move "
            "it apart from others, or drive none of its nodes");
}

TEST(Untangle, ShrinksBodiesUntilTheyAreApart) {
  for (const double distance : {0.19, 0.1, 0.03}) {
    PreparedStart start(two_balls(distance), true);
    EXPECT_TRUE(start.conflicts().empty());
    EXPECT_FALSE(start.growth.empty());
    EXPECT_NE(start.before, start.touch.model.start.position);
  }
}

/// Bodies that only are nearer than the thickness are pushed apart, not shrunk.
TEST(Untangle, LeavesBodiesThatTouch) {
  Scene scene = two_balls(0.201);
  scene.bodies[0] = elastic_box("left", {0.1, 0.1, 0.1}, {1, 1, 1});
  scene.bodies[1] = elastic_box("right", {0.1, 0.1, 0.1}, {1, 1, 1});
  scene.bodies[1].pose.position = {0.2, 0.01, 0.02};
  PreparedStart start(scene, true);
  EXPECT_TRUE(start.growth.empty());
  EXPECT_TRUE(start.conflicts().empty());
}

TEST(Untangle, RigidBodiesCannotShrink) {
  Scene scene = two_balls(0.15);
  scene.bodies[0] = rigid_ball("left", 0.1, {0, 0, 0});
  scene.bodies[1] = rigid_ball("right", 0.1, {0.15, 0, 0});
  EXPECT_EQ(message_of([&] {
              PreparedStart(scene, true);
            }).find("bodies[0] 'left' intersects bodies[1] 'right' at the start"),
            0U);
  scene.bodies[1] = soft_ball("right", {0.15, 0, 0});
  EXPECT_TRUE(PreparedStart(scene, true).conflicts().empty());
}

TEST(Untangle, CannotHelpABodyThatIntersectsItself) {
  Body cloth = sheet_body("cloth", {1, 1}, {1, 1});
  cloth.geometry = Surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.2, -0.1}, {0.2, 0.2, 0.1}},
                           {{{0, 1, 2}}, {{0, 3, 4}}}};
  Scene scene = scene_of({cloth}, 0.01);
  scene.thickness = 1e-3;
  EXPECT_EQ(message_of([&] { PreparedStart(scene, true); }),
            "bodies[0] 'cloth': it intersects itself at the start, which untangle cannot "
            "change; set its self to false or change its shape");
}

}  // namespace
}  // namespace tetwarp::test

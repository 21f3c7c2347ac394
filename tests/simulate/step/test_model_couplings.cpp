#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/nearest.hpp"
#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

/// The grid finds what a search of all tetrahedra finds.
TEST(NearestItems, AgreesWithASearchOfAll) {
  const Scene scene = scene_of({elastic_box("box", {0.5, 0.3, 0.2}, {6, 5, 4})}, 0.01);
  const SceneGeometry geometry = make_scene_geometry(scene);
  const BodyGeometry& box = geometry.bodies[0];
  const NearestItems<4> tets(box.nodes, box.tets);
  const NearestItems<3> triangles(box.surface.points, box.surface.triangles);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1.2, 1.2);
  for (int i = 0; i < 300; ++i) {
    const Point3 x{place(random), place(random), place(random)};
    double nearest_tet = std::numeric_limits<double>::infinity(), nearest_triangle = nearest_tet;
    for (const auto& tet : box.tets) {
      const std::array corners{at(box.nodes, tet[0]), at(box.nodes, tet[1]), at(box.nodes, tet[2]),
                               at(box.nodes, tet[3])};
      nearest_tet = std::min(nearest_tet, nearest_on(corners, x).distance);
    }
    for (const auto& triangle : box.surface.triangles) {
      const auto& points = box.surface.points;
      const std::array corners{at(points, triangle[0]), at(points, triangle[1]),
                               at(points, triangle[2])};
      nearest_triangle = std::min(nearest_triangle, nearest_on(corners, x).distance);
    }
    EXPECT_EQ(tets.find(x).distance, nearest_tet);
    EXPECT_EQ(triangles.find(x).distance, nearest_triangle);
    const auto found = tets.find(x);
    EXPECT_NEAR(found.weight[0] + found.weight[1] + found.weight[2] + found.weight[3], 1, 1e-12);
  }
}

/// Closest points of a box by its closed form.
TEST(NearestItems, DistanceToABoxIsItsClosedForm) {
  const Scene scene = scene_of({elastic_box("box", {0.5, 0.3, 0.2}, {3, 3, 3})}, 0.01);
  const SceneGeometry geometry = make_scene_geometry(scene);
  const NearestItems<4> tets(geometry.bodies[0].nodes, geometry.bodies[0].tets);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-2, 2);
  for (int i = 0; i < 200; ++i) {
    const Point3 x{place(random), place(random), place(random)};
    const double expected =
        std::hypot(std::max(std::abs(x[0]) - 0.5, 0.0), std::max(std::abs(x[1]) - 0.3, 0.0),
                   std::max(std::abs(x[2]) - 0.2, 0.0));
    EXPECT_NEAR(tets.find(x).distance, expected, 1e-13);
  }
}

Scene two_boxes(const std::array<std::int64_t, 3>& cells) {
  Scene scene = scene_of(
      {elastic_box("a", {0.1, 0.1, 0.1}, cells), elastic_box("b", {0.1, 0.1, 0.1}, {3, 3, 3})},
      0.01);
  scene.bodies[1].pose.position = {0, 0, 0.25};
  scene.couplings = {{.a = "a",
                      .b = "b",
                      .select_a = {HalfSpaceSelection{{0, 0, 1}, 0.09}},
                      .stiffness = 600,
                      .damping = 6}};
  return scene;
}

/// The total does not depend on the mesh, and each spring ends where b is nearest.
TEST(Coupling, SharesItsStiffness) {
  for (const std::int64_t n : {1, 2, 5}) {
    const Model model = model_of(two_boxes({n, n, n}));
    EXPECT_NEAR(total(model.springs.stiffness), 600, 1e-10);
    EXPECT_NEAR(total(model.springs.damping), 6, 1e-12);
    ASSERT_EQ(model.springs.a.size(), static_cast<std::size_t>((n + 1) * (n + 1)));
    for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
      const Point3 a = position_of(model.springs.a[s], model.start, model.node_count);
      const Point3 b = position_of(model.springs.b[s], model.start, model.node_count);
      EXPECT_LT(distance_of(b, {a[0], a[1], 0.15}), 1e-13);
    }
  }
}

TEST(Coupling, LeavesOutWhatIsTooFar) {
  Scene scene = two_boxes({2, 2, 2});
  scene.couplings[0].select_a = {AllSelection{}};
  scene.couplings[0].within = 0.06;
  const Model model = model_of(scene);

  EXPECT_EQ(model.springs.a.size(), 9U);
  EXPECT_NEAR(total(model.springs.stiffness), 600, 1e-10);
}

TEST(Coupling, RefusesPointsFarOutsideOfElasticBodies) {
  Scene scene = two_boxes({1, 1, 1});
  scene.couplings[0].select_a = {};
  scene.couplings[0].points = {{0, 0, 1}};
  try {
    model_of(scene);
    FAIL() << "ties a point far from both bodies";
  } catch (const std::invalid_argument& error) {
    EXPECT_EQ(std::string(error.what()).find("couplings[0].points[0]: is 0.9 m outside"), 0U)
        << error.what();
  }
  scene.couplings[0].within = 1;
  EXPECT_EQ(model_of(scene).springs.a.size(), 1U);
}

/// Springs to a plane end on its surface, to a moving obstacle in its frame; a rigid body is solid.
TEST(Coupling, TiesToObstaclesAndRigidBodies) {
  Scene scene = two_boxes({1, 1, 1});
  scene.bodies[1] = rigid_box("b", {0.3, 0.3, 0.3}, {0, 0, 0.35});
  scene.obstacles.push_back({"floor", PlaneObstacle{{0, 0, 2}, {0, 0, -0.3}}, {}, {}});
  scene.couplings.push_back({.a = "a",
                             .b = "floor",
                             .select_a = {HalfSpaceSelection{{0, 0, -1}, 0.09}},
                             .stiffness = 10});
  const Model model = model_of(scene);

  EXPECT_EQ(model.rigid_count, 2);
  for (std::size_t s = 0; s < model.springs.a.size(); ++s) {
    const Point3 a = position_of(model.springs.a[s], model.start, model.node_count);
    const Point3 b = position_of(model.springs.b[s], model.start, model.node_count);
    const double end = model.springs.coupling[s] == 0 ? 0.1 : -0.3;
    EXPECT_LT(distance_of(b, {a[0], a[1], end}), 1e-13);
  }
  EXPECT_EQ(model.body_island, (std::vector<std::int32_t>{0, 0}));
}

/// Islands join over couplings between bodies that can move, named by their first body.
TEST(Islands, AreComponentsOfBodiesThatMove) {
  Scene scene;
  for (int i = 0; i < 6; ++i) {
    scene.bodies.push_back(rigid_box("body" + std::to_string(i), {0.1, 0.1, 0.1}, {0.3 * i, 0, 0}));
  }
  Body script;
  script.name = "script";
  script.kind = BodyKind::scripted;
  scene.bodies.push_back(script);
  scene = scene_of(scene.bodies, 0.01);
  for (const auto& [a, b] : std::vector<std::array<std::string, 2>>{
           {"body5", "body1"}, {"body3", "body5"}, {"body2", "script"}, {"body4", "script"}}) {
    scene.couplings.push_back({.a = a, .b = b, .points = {{0, 0, 0}}, .stiffness = 1});
  }
  const Model model = model_of(scene);

  EXPECT_EQ(model.body_island, (std::vector<std::int32_t>{0, 1, 2, 1, 3, 1, -1}));
  EXPECT_EQ(model.island_count, 4);
}

}  // namespace
}  // namespace tetwarp::test

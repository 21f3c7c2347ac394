/// @file test_scene_surfaces.cpp
/// What can touch in a scene: parts of bodies of every kind, areas, pairs that never touch, the
/// contact distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <tetwarp/surface.hpp>

#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/simulate/surfaces/surface_motion.hpp"
#include "tests/simulate/touch_scenes.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/torn_mesh.hpp"

namespace tetwarp::test {
namespace {

using Pairs = std::vector<std::array<std::int32_t, 2>>;

int vertices_of(const CollisionBody& body) {
  return body.vertex_end - body.first_vertex;
}
int edges_of(const CollisionBody& body) {
  return body.edge_end - body.first_edge;
}
int triangles_of(const CollisionBody& body) {
  return body.triangle_end - body.first_triangle;
}

double area_of(const Surface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    sum += norm(cross(minus(at(surface.points, b), at(surface.points, a)),
                      minus(at(surface.points, c), at(surface.points, a)))) /
           2;
  }
  return sum;
}

AdhesionMaterial glue(double energy) {
  AdhesionMaterial adhesion;
  adhesion.stiffness = 1e6;
  adhesion.energy = energy;
  return adhesion;
}

Scene all_kinds() {
  Body elastic = elastic_box("elastic", {0.1, 0.1, 0.1}, {2, 2, 2});
  elastic.pose = {{1, 2, 3}, {0.5, 0.5, -0.5, 0.5}};
  Body sheet = sheet_body("sheet", {0.3, 0.2}, {3, 2});
  sheet.pose.position = {0, 0, 2};
  Body paddle;
  paddle.name = "paddle";
  paddle.kind = BodyKind::scripted;
  paddle.geometry = Shape{BoxShape{{0.1, 0.2, 0.3}}};
  paddle.surface = std::int64_t{12};
  paddle.motion = Path{{0, Point3{5, 0, 0}}, {1, Point3{6, 0, 0}}};
  Body jaw;
  jaw.name = "jaw";
  jaw.kind = BodyKind::scripted;
  Scene scene =
      scene_of({elastic, rigid_box("box", {0.1, 0.1, 0.1}, {-1, 0, 0}), sheet, paddle, jaw,
                rigid_ball("ball", 0.3, {0, 5, 0}), rigid_capsule("pill", 0.1, 0.4, {0, -5, 0})},
               0.01);
  Surface tile{{{0, 0, 0}, {1, 0, 0}, {9, 9, 9}, {0, 1, 0}}, {{{0, 1, 3}}}};
  scene.obstacles = {{"floor", PlaneObstacle{{0, 0, 2}, {0, 0, -4}}, {}, {}},
                     {"dome", SphereObstacle{{0, 0, -6}, 0.7}, {}, {}},
                     {"bar", CapsuleObstacle{{0, 0, -7}, {1, 0, -7}, 0.2}, {}, {}},
                     {"tile", tile, {}, {}}};
  return scene;
}

/// Where parts meet with nodes of their own, each vertex moves with its own node.
TEST(SceneSurfaces, VerticesOfBoundariesAreTheirNodes) {
  const Mesh whole = make_lattice_mesh(make_shape_surface(BoxShape{{1, 1, 1}}, 12), 2);
  for (const std::uint32_t seed : {1, 2, 3}) {
    Body body = elastic_box("torn", {1, 1, 1}, {1, 1, 1});
    body.geometry = test::torn(whole, seed);
    body.lattice.reset();
    const TouchScene touch(scene_of({body}, 0.01));
    const BodyGeometry& of = touch.geometry.bodies[0];
    const BoundPoints bound = bind_boundary({of.nodes, of.tets, {}});

    ASSERT_EQ(touch.surfaces.vertex_point.size(), bound.nodes.size());
    for (std::size_t v = 0; v < bound.nodes.size(); ++v) {
      const ModelPoint& point = touch.surfaces.vertex_point[v];
      const auto one = std::find(bound.weights[v].begin(), bound.weights[v].end(), 1);
      EXPECT_EQ(point.node[0],
                bound.nodes[v][static_cast<std::size_t>(one - bound.weights[v].begin())]);
      EXPECT_EQ(point.node[1], -1);
      EXPECT_EQ(point.weight[0], 1);
    }
  }
}

TEST(SceneSurfaces, HoldThePartsOfEveryKind) {
  const TouchScene touch(all_kinds());
  const CollisionSurfaces& surfaces = touch.surfaces.surfaces;

  ASSERT_EQ(touch.surfaces.body_count(), 11);
  // 2 x 2 x 2 boxes: 6 x 4 faces of two triangles, Euler: V - E + F = 2
  EXPECT_EQ(vertices_of(touch.body(0)), 26);
  EXPECT_EQ(edges_of(touch.body(0)), 72);
  EXPECT_EQ(triangles_of(touch.body(0)), 48);
  EXPECT_EQ(vertices_of(touch.body(2)), 12);
  EXPECT_EQ(triangles_of(touch.body(2)), 12);
  EXPECT_EQ(edges_of(touch.body(2)), 9 + 8 + 6);
  EXPECT_GT(triangles_of(touch.body(3)), 0);
  EXPECT_EQ(vertices_of(touch.body(4)), 0);  // a scripted body without geometry
  EXPECT_EQ(vertices_of(touch.body(5)), 1);
  EXPECT_EQ(edges_of(touch.body(5)), 0);
  EXPECT_EQ(vertices_of(touch.body(6)), 2);
  EXPECT_EQ(edges_of(touch.body(6)), 1);
  EXPECT_EQ(triangles_of(touch.body(6)), 0);
  EXPECT_EQ(touch.body(7).plane_end - touch.body(7).first_plane, 1);
  EXPECT_EQ(vertices_of(touch.body(8)), 1);
  EXPECT_EQ(edges_of(touch.body(9)), 1);
  EXPECT_EQ(vertices_of(touch.body(10)), 3);  // not the point that no triangle uses
  EXPECT_EQ(at(touch.surfaces.surface_point, touch.body(10).vertex_end - 1), 3);

  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const bool moves = b == 0 || b == 1 || b == 2 || b == 5 || b == 6;
    EXPECT_EQ(surfaces.bodies[b].has_unknowns, moves) << b;
    EXPECT_EQ(surfaces.bodies[b].touches_itself, b == 2) << b;
    EXPECT_EQ(touch.surfaces.surfaces.bodies[b].is_rigid, b != 0 && b != 2 && b != 3) << b;
    for (std::int32_t v = surfaces.bodies[b].first_vertex; v < surfaces.bodies[b].vertex_end; ++v) {
      EXPECT_EQ(at(surfaces.vertex_body, v), static_cast<std::int32_t>(b));
      EXPECT_EQ(at(touch.surfaces.vertex_point, v).body, static_cast<std::int32_t>(b));
    }
  }
  std::set<std::array<std::int32_t, 2>> edges;
  for (auto [a, b] : surfaces.edges)
    EXPECT_TRUE(edges.insert({std::min(a, b), std::max(a, b)}).second);
  EXPECT_EQ(surfaces.edge_radius.size(), surfaces.edges.size());
  EXPECT_EQ(surfaces.vertex_radius.size(), surfaces.vertex_body.size());
  EXPECT_EQ(touch.surfaces.body_size[7], std::numeric_limits<double>::infinity());
  EXPECT_NEAR(touch.surfaces.body_size[5], 0.6 * std::sqrt(3), 1e-14);
  EXPECT_NEAR(touch.surfaces.body_size[6], std::hypot(0.2, 0.2, 0.6), 1e-14);
}

TEST(SceneSurfaces, AreWhereTheBodiesStart) {
  const TouchScene touch(all_kinds());
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);

  const auto of_body = [&](std::size_t b) {
    Bounds bounds;
    for (std::int32_t v = touch.body(b).first_vertex; v < touch.body(b).vertex_end; ++v) {
      bounds.include(at(places.vertices, v));
    }
    return bounds;
  };
  EXPECT_LT(norm(minus(of_body(0).low, {0.9, 1.9, 2.9})), 1e-12);
  EXPECT_LT(norm(minus(of_body(3).high, {5.1, 0.2, 0.3})), 1e-12);  // its path at time 0
  EXPECT_LT(norm(minus(of_body(5).low, {0, 5, 0})), 1e-12);
  EXPECT_LT(norm(minus(of_body(6).high, {0, -5, 0.2})), 1e-12);
  EXPECT_LT(norm(minus(of_body(9).high, {1, 0, -7})), 1e-12);
  EXPECT_EQ(places.planes[0].point, (Point3{0, 0, -4}));
  EXPECT_EQ(places.planes[0].normal, (Point3{0, 0, 1}));
}

TEST(SceneSurfaces, AreasOfVerticesSumToThatOfTheSurface) {
  const TouchScene touch(all_kinds());
  const auto area = [&](std::size_t b) {
    double sum = 0;
    for (std::int32_t v = touch.body(b).first_vertex; v < touch.body(b).vertex_end; ++v) {
      sum += at(touch.surfaces.surfaces.vertex_area, v);
    }
    return sum;
  };
  for (std::size_t b = 0; b < 4; ++b) {
    const double exact = area_of(touch.geometry.bodies[b].surface);
    EXPECT_NEAR(area(b), exact, 1e-12 * exact) << b;
  }
  EXPECT_EQ(area(5), 0);
  EXPECT_EQ(area(6), 0);
  EXPECT_NEAR(area(10), 0.5, 1e-14);
}

/// Areas are those of the start pose, where driven nodes have been moved.
TEST(SceneSurfaces, AreasAreThoseOfTheStart) {
  Body sheet = sheet_body("sheet", {1, 1}, {1, 1});
  sheet.driven = {{{HalfSpaceSelection{{1, 0, 0}, 0.5}}, {{0, Point3{1, 0, 0}}}}};
  const TouchScene touch(scene_of({sheet}, 0.01));

  EXPECT_NEAR(total(touch.surfaces.surfaces.vertex_area), 2, 1e-14);
}

TEST(SceneSurfaces, LeaveOutBodiesThatDoNotCollide) {
  Scene scene = all_kinds();
  for (Body& body : scene.bodies) body.collide = false;
  const TouchScene touch(scene);

  for (std::size_t b = 0; b < 7; ++b) {
    EXPECT_EQ(vertices_of(touch.body(b)), 0);
    EXPECT_EQ(triangles_of(touch.body(b)), 0);
    EXPECT_EQ(touch.surfaces.body_size[b], 0);
  }
  EXPECT_EQ(vertices_of(touch.body(8)), 1);
}

TEST(SceneSurfaces, BodiesWithoutUnknownsAreMarked) {
  Body held = elastic_box("held", {0.1, 0.1, 0.1}, {1, 1, 1});
  held.fixed = {AllSelection{}};
  Body half = elastic_box("half", {0.1, 0.1, 0.1}, {1, 1, 1});
  half.pose.position = {1, 0, 0};
  half.fixed = {HalfSpaceSelection{{0, 0, 1}, 0.05}};
  half.self = true;
  Body flag = sheet_body("flag", {1, 1}, {2, 2});
  flag.pose.position = {0, 0, 3};
  flag.self = false;
  const TouchScene touch(scene_of({held, half, flag}, 0.01));

  EXPECT_FALSE(touch.body(0).has_unknowns);
  EXPECT_TRUE(touch.body(1).has_unknowns);
  EXPECT_TRUE(touch.body(1).touches_itself);
  EXPECT_FALSE(touch.body(2).touches_itself);
}

TEST(SceneSurfaces, PairsThatNeverTouchAreForbidden) {
  Scene scene = all_kinds();
  scene.contact.pairs = {{.a = "box", .b = "elastic", .collide = false},
                         {.a = "sheet", .b = "sheet", .collide = false},
                         {.a = "box", .b = "floor", .friction = 0.5}};
  scene.couplings = {
      {.a = "sheet", .b = "box", .points = {{0, 0, 1}}, .stiffness = 1},
      {.a = "box", .b = "elastic", .points = {{0, 0, 1}}, .stiffness = 1},
      {.a = "box", .b = "world", .points = {{0, 0, 1}}, .stiffness = 1},
      {.a = "box", .b = "dome", .points = {{0, 0, 1}}, .stiffness = 1},
      {.a = "sheet", .b = "elastic", .points = {{0, 0, 1}}, .stiffness = 1, .collide = true}};
  for (Coupling& coupling : scene.couplings) coupling.within = 10;
  const TouchScene touch(scene);

  EXPECT_EQ(touch.surfaces.surfaces.forbidden, (Pairs{{0, 1}, {1, 2}, {1, 8}, {2, 2}}));
  EXPECT_FALSE(touch.body(2).touches_itself);
}

/// Adhesion acts on areas, which triangles have: a round body that adheres uses them.
TEST(SceneSurfaces, RoundBodiesThatAdhereUseTheirTriangles) {
  Scene scene = all_kinds();
  scene.contact.pairs = {
      {.a = "ball", .b = "bar", .has_adhesion = true, .adhesion = glue(1)},
      {.a = "pill", .b = "box", .has_adhesion = true, .adhesion = glue(1), .collide = false}};
  const TouchScene touch(scene);
  const CollisionSurfaces& surfaces = touch.surfaces.surfaces;

  EXPECT_EQ(triangles_of(touch.body(5)), 1280);
  EXPECT_EQ(vertices_of(touch.body(6)), 2);  // may not meet what it would adhere to
  EXPECT_EQ(vertices_of(touch.body(8)), 1);
  ASSERT_GT(triangles_of(touch.body(9)), 1000);
  SurfacePlaces places;
  surface_places(touch.surfaces, touch.model, touch.model.start, 1, places);
  for (std::int32_t v = touch.body(9).first_vertex; v < touch.body(9).vertex_end; ++v) {
    const Point3& x = at(places.vertices, v);
    const double along = std::clamp(x[0], 0.0, 1.0);
    EXPECT_NEAR(norm(minus(x, {along, 0, -7})), 0.2, 1e-12);
    EXPECT_EQ(at(surfaces.vertex_radius, v), 0);
  }

  Scene without = all_kinds();
  without.contact.material.adhesion = glue(1);
  without.bodies.erase(without.bodies.begin(), without.bodies.begin() + 6);
  without.bodies.front().contact = SurfaceContact{0.5, std::nullopt};
  const TouchScene obstacles(without);
  EXPECT_EQ(vertices_of(obstacles.body(0)), 2);
  EXPECT_EQ(vertices_of(obstacles.body(2)), 1);  // obstacles do not meet each other
}

TEST(SceneSurfaces, GivenSurfacesAndEllipsoidsAreNotRound) {
  Body ball = rigid_ball("ball", 1, {0, 0, 0});
  ball.surface = make_shape_surface(EllipsoidShape{{1, 1, 1}}, 80);
  Body egg = rigid_ball("egg", 1, {5, 0, 0});
  egg.geometry = Shape{EllipsoidShape{{1, 1, 1.1}}};
  Body point = rigid_capsule("point", 1, 0, {10, 0, 0});
  const TouchScene touch(scene_of({ball, egg, point}, 0.01));

  EXPECT_EQ(triangles_of(touch.body(0)), 80);
  EXPECT_GT(triangles_of(touch.body(1)), 0);
  EXPECT_EQ(vertices_of(touch.body(2)), 1);
  EXPECT_EQ(edges_of(touch.body(2)), 0);
}

TEST(ContactThickness, IsAThousandthOfTheMedianEdge) {
  Scene scene = scene_of({sheet_body("sheet", {3, 2}, {3, 2})}, 0.01);
  EXPECT_NEAR(TouchScene(scene).surfaces.surfaces.thickness, 1e-3, 1e-15);
  scene.bodies.push_back(rigid_ball("ball", 0.1, {0, 0, 5}));
  EXPECT_NEAR(TouchScene(scene).surfaces.surfaces.thickness, 1e-3, 1e-15);
  scene.bodies.erase(scene.bodies.begin());
  scene.bodies.push_back(rigid_capsule("pill", 0.02, 5, {0, 0, 9}));
  EXPECT_NEAR(TouchScene(scene).surfaces.surfaces.thickness, 2e-5, 1e-18);
  scene.thickness = 0.125;
  EXPECT_EQ(TouchScene(scene).surfaces.surfaces.thickness, 0.125);
  for (Body& body : scene.bodies) body.collide = false;
  scene.thickness.reset();
  EXPECT_EQ(TouchScene(scene).surfaces.surfaces.thickness, 1e-3);
}

/// Whether flat faces are divided has no effect on it.
TEST(ContactThickness, OfWholeFacesIsThatOfDividedOnes) {
  Scene scene = scene_of(
      {rigid_box("box", {0.1, 0.2, 0.3}, {4, 5, 6}), sheet_body("sheet", {0.3, 0.2}, {9, 8})},
      0.01);
  const TouchScene whole(scene);
  scene.bodies[0].surface = std::int64_t{1280};
  const TouchScene divided(scene);

  EXPECT_EQ(triangles_of(whole.body(0)), 12);
  EXPECT_GT(triangles_of(divided.body(0)), 1000);
  const double thickness = divided.surfaces.surfaces.thickness;
  EXPECT_NEAR(whole.surfaces.surfaces.thickness, thickness, 1e-12 * thickness);
}

TEST(ContactThickness, ThatCannotBeResolvedIsAnError) {
  Scene scene = scene_of({sheet_body("sheet", {1, 1}, {1, 1})}, 0.01);
  scene.thickness = 1e-11;
  const auto message = [&] { return message_of([&] { TouchScene{scene}; }); };
  EXPECT_EQ(message(),
            "bodies[0] 'sheet': the contact distance 1e-11 m cannot be resolved on edges or radii "
            "of 1.41421 m; divide them, or set thickness to 1.41421e-10 or more");
  scene.thickness = 1e-7;
  scene.bodies[0].pose.position = {0, -1e6, 0};
  EXPECT_EQ(message(),
            "bodies[0] 'sheet': the contact distance 1e-07 m cannot be resolved at coordinates of "
            "1e+06 m; move the scene nearer to the origin, or set thickness to 1e-06 or more");
  scene.thickness = 1e-5;
  EXPECT_EQ(message(), "");
}

}  // namespace
}  // namespace tetwarp::test

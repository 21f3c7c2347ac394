/// @file test_scene_geometry.cpp
/// Bodies of scenes: nodes and triangles by kind, selections, errors that name the place.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "host/scene/scene_geometry.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/scene/shapes/surface.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp {
namespace {
using scene_checks::is_manifold;

Body box_body(BodyKind kind) {
  Body body;
  body.name = "box";
  body.kind = kind;
  body.geometry = Shape{BoxShape{{1, 0.5, 0.5}}};
  if (kind == BodyKind::fem) body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{2, 1, 1}};
  return body;
}

Body cloth_body() {
  Body body;
  body.name = "cloth";
  body.kind = BodyKind::cloth;
  body.geometry = Sheet{{2, 1}, {4, 3}, {0, 0, 1}, {{{1, 0, 0}, {0, 1, 0}}}};
  return body;
}

Scene scene_of(std::vector<Body> bodies) {
  Scene scene;
  scene.time_step = 0.01;
  scene.bodies = std::move(bodies);
  return scene;
}

std::string error_of(const Scene& scene) {
  return test::message_of([&] { make_scene_geometry(scene); });
}

/// Positions that miss the decimals of a limit by rounding alone are within it, others are not.
TEST(SceneGeometry, LimitsOfSelectionsHoldUpToRounding) {
  Body body = box_body(BodyKind::fem);
  body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{7, 3, 3}};
  body.pose.position = {0.1 + 0.2, 0.7, 0};
  const double end = 1.3, side = 1.2;  // 0.30000000000000004 + 1, 0.7 + 0.5
  const auto count = [&](const SelectionPart& part) {
    body.fixed = {part};
    return make_scene_geometry(scene_of({body})).bodies[0].fixed.size();
  };
  for (const double rounding : {0.0, 3e-16, -3e-16, 5e-10, -5e-10}) {
    EXPECT_EQ(count(HalfSpaceSelection{{2, 0, 0}, 2 * (end + rounding)}), 16U);
    EXPECT_EQ(count(HalfSpaceSelection{{0, 1, 0}, side + rounding}), 32U);
    EXPECT_EQ(count(BoxSelection{{end + rounding, 0, -1}, {end + rounding, 2, 1}}), 16U);
    EXPECT_EQ(count(SphereSelection{{end, side, 1.5}, 1 + rounding}), 1U);
  }
  EXPECT_EQ(count(HalfSpaceSelection{{1, 0, 0}, end - 2.0 / 7 - 1e-8}), 32U);
  EXPECT_EQ(count(HalfSpaceSelection{{1, 0, 0}, end - 2.0 / 7 + 1e-8}), 16U);
}

TEST(SceneGeometry, OfAFemBoxIsItsLatticeAndBoundary) {
  const BodyGeometry box = make_scene_geometry(scene_of({box_body(BodyKind::fem)})).bodies[0];

  EXPECT_EQ(box.nodes.size(), 12u);
  EXPECT_EQ(box.tets.size(), 10u);
  EXPECT_TRUE(is_manifold(box.surface));
  EXPECT_EQ(box.surface.triangles.size(), 20u);
  EXPECT_NEAR(volume_of(box.surface), 2, 1e-14);
  EXPECT_EQ(box.cells_across, (std::array<double, 3>{2, 1, 1}));
}

TEST(SceneGeometry, OfARigidBodyIsAClosedSurface) {
  Body rigid = box_body(BodyKind::rigid);
  rigid.surface = std::int64_t{500};

  const BodyGeometry box = make_scene_geometry(scene_of({rigid})).bodies[0];

  EXPECT_TRUE(box.nodes.empty());
  EXPECT_TRUE(is_manifold(box.surface));
  EXPECT_NEAR(volume_of(box.surface), 2, 1e-13);
}

TEST(SceneGeometry, OfASheetIsRowsOfNodes) {
  const BodyGeometry cloth = make_scene_geometry(scene_of({cloth_body()})).bodies[0];

  EXPECT_EQ(cloth.nodes.size(), 20u);
  EXPECT_EQ(cloth.nodes[6], (Point3{0.5, 1.0 / 3, 1}));
  EXPECT_EQ(cloth.cloth_triangles.size(), 24u);
  EXPECT_EQ(cloth.sheet_cells, (std::array<std::int64_t, 2>{4, 3}));
  EXPECT_EQ(cloth.surface.points, cloth.nodes);
  double area = 0;
  for (const auto& [a, b, c] : cloth.cloth_triangles) {
    const Point3 normal = cross(minus(at(cloth.nodes, b), at(cloth.nodes, a)),
                                minus(at(cloth.nodes, c), at(cloth.nodes, a)));
    EXPECT_GT(normal[2], 0);
    area += 0.5 * norm(normal);
  }
  EXPECT_NEAR(area, 2, 1e-14);
}

TEST(SceneGeometry, OfAMeshHasPositiveVolumesAndItsNodesRenumbered) {
  Body body;
  body.name = "mesh";
  body.geometry = Mesh{{{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{1, 2, 4, 3}}};
  body.fixed = {NodeSelection{{1, 4}}};

  const BodyGeometry mesh = make_scene_geometry(scene_of({body})).bodies[0];

  EXPECT_EQ(mesh.nodes.size(), 4u);
  EXPECT_EQ(scene_checks::volumes_of(mesh.nodes, mesh.tets), (std::vector<double>{1.0 / 6}));
  EXPECT_EQ(mesh.fixed, (std::vector<std::int32_t>{0, 3}));
  body.fixed = {NodeSelection{{0}}};
  EXPECT_EQ(error_of(scene_of({body})), "bodies[0].fixed: node 0 belongs to no cell of the mesh");
}

TEST(SceneGeometry, RefusesTetrahedraThatAreThereTwice) {
  Body body;
  body.name = "mesh";
  body.geometry =
      Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {{0, 1, 2, 3}, {4, 0, 2, 3}}};

  EXPECT_EQ(error_of(scene_of({body})),
            "bodies[0].mesh: tetrahedra 0 and 1 are the same and would count twice, remove one of "
            "them");
}

/// 12 triangles of a box, unless the scene needs points within its faces or asks for them.
TEST(SceneGeometry, FlatFacesAreDividedWhereThatIsNeeded) {
  const auto count = [](const Scene& scene) {
    return make_scene_geometry(scene).bodies[0].surface.triangles.size();
  };
  Body box = box_body(BodyKind::rigid);
  const std::size_t divided =
      make_shape_surface(std::get<Shape>(box.geometry), 1280).triangles.size();
  EXPECT_EQ(count(scene_of({box})), 12u);
  Scene scripted = scene_of({box});
  scripted.bodies[0].kind = BodyKind::scripted;
  EXPECT_EQ(count(scripted), 12u);
  scripted.bodies[0].motion = Wave{};
  EXPECT_EQ(count(scripted), divided);
  Scene asked = scene_of({box});
  asked.bodies[0].surface = std::int64_t{100};
  EXPECT_EQ(count(asked), make_shape_surface(std::get<Shape>(box.geometry), 100).triangles.size());
  Scene pulled = scene_of({box});
  pulled.handles.resize(1);
  pulled.handles[0].body = box.name;
  pulled.handles[0].select = {AllSelection{}};
  EXPECT_EQ(count(pulled), divided);
  Scene sticky = scene_of({box});
  sticky.contact.material.adhesion = AdhesionMaterial{};
  EXPECT_EQ(count(sticky), divided);
}

TEST(SceneGeometry, SelectsByThePositionsAfterThePose) {
  Body body = box_body(BodyKind::fem);
  const double half_turn = std::sqrt(0.5);
  body.pose = {{10, 0, 0}, {half_turn, 0, 0, half_turn}};  // x to y
  body.fixed = {HalfSpaceSelection{{0, 1, 0}, 1 - 1e-9}};
  body.driven = {{{BoxSelection{{9, -1.1, -1}, {11, -0.9, 0}}}, {}}};

  const Scene scene = scene_of({body});
  const BodyGeometry box = make_scene_geometry(scene).bodies[0];

  ASSERT_EQ(box.fixed.size(), 4u);
  for (const std::int32_t node : box.fixed) EXPECT_EQ(at(box.nodes, node)[0], 1);
  ASSERT_EQ(box.driven.size(), 1u);
  EXPECT_EQ(box.driven[0].nodes.size(), 2u);
  EXPECT_EQ(box.driven[0].path, &scene.bodies[0].driven[0].path);
}

TEST(SceneGeometry, SelectsUnionsInOrderOnce) {
  Scene scene = scene_of({box_body(BodyKind::fem), box_body(BodyKind::rigid)});
  scene.bodies[1].name = "rigid";
  scene.handles.resize(2);
  scene.handles[0].body = "box";
  scene.handles[0].select = {NodeSelection{{7, 3, 3}}, SphereSelection{{1, 0.5, 0.5}, 0.1}};
  scene.handles[1].body = "rigid";
  scene.handles[1].select = {SphereSelection{{1, 0.5, 0.5}, 1e-6}};
  scene.loads.resize(1);
  scene.loads[0].body = "box";
  scene.loads[0].select = {AllSelection{}};
  scene.loads[0].pressure = 1;

  const SceneGeometry geometry = make_scene_geometry(scene);

  EXPECT_EQ(geometry.handle_nodes[0], (std::vector<std::int32_t>{3, 7, 11}));
  EXPECT_EQ(geometry.handle_nodes[1].size(), 1u);
  EXPECT_EQ(geometry.load_nodes[0].size(), geometry.bodies[0].surface.points.size());
}

TEST(SceneGeometry, SelectsNodesByTheLabelOfOwnedVoxels) {
  Body body;
  body.name = "image";
  ImageGeometry image{make_volume({{8, 2, 2}}, PixelType::uint8), 1};
  const auto samples = image.volume.samples<std::uint8_t>();
  for (std::size_t v = 0; v < samples.size(); ++v) samples[v] = v % 8 < 2 ? 2 : 1;
  body.geometry = image;
  body.lattice = Lattice{.cells = std::array<std::int64_t, 3>{4, 1, 1}};
  body.fixed = {LabelSelection{2}};

  const BodyGeometry geometry = make_scene_geometry(scene_of({body})).bodies[0];

  EXPECT_FALSE(geometry.fixed.empty());
  for (const std::int32_t node : geometry.fixed) EXPECT_LE(at(geometry.nodes, node)[0], 1.5);
  EXPECT_EQ(std::count_if(geometry.nodes.begin(), geometry.nodes.end(),
                          [](const Point3& x) { return x[0] <= 1.5; }),
            static_cast<std::ptrdiff_t>(geometry.fixed.size()));
  body.fixed = {LabelSelection{5}};
  EXPECT_NE(error_of(scene_of({body})).find("bodies[0].fixed: selects nothing"), std::string::npos);
}

TEST(SceneGeometry, ScriptedBodiesHaveNodesOrNothing) {
  Body jaw;
  jaw.name = "jaw";
  jaw.kind = BodyKind::scripted;
  Body ball = jaw;
  ball.name = "ball";
  ball.geometry = Shape{EllipsoidShape{{1, 1, 1}}};

  const SceneGeometry geometry = make_scene_geometry(scene_of({jaw, ball}));

  EXPECT_TRUE(geometry.bodies[0].nodes.empty());
  EXPECT_EQ(geometry.bodies[1].nodes, geometry.bodies[1].surface.points);
  EXPECT_TRUE(is_manifold(geometry.bodies[1].surface));
}

TEST(SceneGeometry, ErrorsNameThePlace) {
  Body nothing = box_body(BodyKind::fem);
  nothing.fixed = {SphereSelection{{9, 9, 9}, 1}};
  EXPECT_EQ(error_of(scene_of({cloth_body(), nothing})),
            "bodies[1].fixed: selects nothing; at the start 'box' spans [-1, -0.5, -0.5] to "
            "[1, 0.5, 0.5] m");

  Body twice = box_body(BodyKind::fem);
  twice.fixed = {AllSelection{}};
  twice.driven = {{{NodeSelection{{4}}}, {}}};
  EXPECT_EQ(error_of(scene_of({twice})),
            "bodies[0].driven[0].select: selects 1 nodes that are already fixed or driven, the "
            "first is node 4; keep the selections apart");

  Body open = box_body(BodyKind::rigid);
  Surface surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}}};
  open.geometry = surface;
  EXPECT_EQ(error_of(scene_of({open})).substr(0, 36), "bodies[0].mesh: is not closed: 0 tri");
  surface.triangles.push_back({1, 2, 3});
  open.geometry = surface;
  EXPECT_EQ(error_of(scene_of({open})), "");
  for (auto& triangle : surface.triangles) std::swap(triangle[0], triangle[1]);
  open.geometry = surface;
  EXPECT_EQ(error_of(scene_of({open})).substr(0, 40), "bodies[0].mesh: encloses no positive vol");

  Body flat;
  flat.name = "flat";
  flat.geometry = Mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2, 3}}};
  EXPECT_EQ(error_of(scene_of({flat})),
            "bodies[0].mesh: tetrahedron 0 (nodes 0, 1, 2, 3) has no volume, remove it");
}
}  // namespace
}  // namespace tetwarp

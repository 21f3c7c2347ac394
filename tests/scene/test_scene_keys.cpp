/// @file test_scene_keys.cpp
/// Every key of scene files reaches its member, and members without a key keep their default.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <variant>
#include <vector>

#include "host/base/point3.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
const Scene& full() {
  static const Scene scene = scene_of(full_scene);
  return scene;
}

TEST(SceneKeys, OfTheScene) {
  EXPECT_EQ(full().time_step, 0.01);
  EXPECT_EQ(full().duration, 0.5);
  EXPECT_EQ(full().step_count(), 50);
  EXPECT_EQ(full().gravity, (Point3{1, 2, 3}));
  EXPECT_EQ(full().thickness, 1e-3);
  EXPECT_EQ(full().solver.contact_tolerance, 1e-5);
  EXPECT_EQ(full().solver.linear_tolerance, 1e-8);
  EXPECT_EQ(full().solver.max_passes, 3);
  EXPECT_EQ(full().solver.max_substeps, 4);
  EXPECT_TRUE(full().solver.pyramid);
  EXPECT_TRUE(full().solver.restrictive);
  EXPECT_TRUE(full().solver.sleeping);
  EXPECT_EQ(full().output.every, 5);
  EXPECT_EQ(full().output.fields, (std::vector<std::string>{"velocity", "stress"}));
  EXPECT_EQ(full().camera->eye, (Point3{1, 2, 3}));
  EXPECT_EQ(full().camera->target, (Point3{4, 5, 6}));
  EXPECT_EQ(full().camera->up, (Point3{0, 1, 0}));
  EXPECT_EQ(full().camera->angle, 0.75);
  ASSERT_EQ(full().cameras.size(), 2u);
  EXPECT_EQ(full().cameras[0].name, "inside");
  EXPECT_EQ(full().cameras[0].camera.eye, (Point3{7, 8, 9}));
  EXPECT_EQ(full().cameras[0].camera.target, (Point3{1, 1, 1}));
  EXPECT_EQ(full().cameras[0].camera.up, (Point3{0, 0, 1}));
  EXPECT_EQ(full().cameras[0].camera.angle, 1.25);
  EXPECT_EQ(full().cameras[1].camera.up, (Point3{1, 0, 0}));
}

TEST(SceneKeys, HaveDefaults) {
  const Scene scene = scene_of(small_scene);
  EXPECT_EQ(scene.gravity, (Point3{0, 0, -9.81}));
  EXPECT_FALSE(scene.thickness);
  EXPECT_EQ(scene.contact.material.friction, 0);
  EXPECT_FALSE(scene.contact.material.adhesion);
  EXPECT_EQ(scene.solver.contact_tolerance, 1e-4);
  EXPECT_EQ(scene.solver.linear_tolerance, 1e-6);
  EXPECT_EQ(scene.solver.max_passes, 5);
  EXPECT_EQ(scene.solver.max_substeps, 16);
  EXPECT_FALSE(scene.solver.pyramid || scene.solver.restrictive || scene.solver.sleeping);
  EXPECT_FALSE(scene.output.every || scene.camera);
  EXPECT_TRUE(scene.cameras.empty());
  EXPECT_EQ(scene.output.rate, 30);
  const Body& ball = scene.bodies[0];
  EXPECT_TRUE(ball.collide);
  EXPECT_FALSE(ball.self || ball.contact || ball.cage_start);
  EXPECT_EQ(ball.pose.rotation, (std::array<double, 4>{1, 0, 0, 0}));
  EXPECT_EQ(ball.damping.alpha, 0);
  EXPECT_EQ(ball.damping.gamma, 2e-3);
  EXPECT_EQ(ball.mass, MassKind::consistent);
  EXPECT_TRUE(scene.couplings.empty() && scene.handles.empty() && scene.loads.empty());
}

TEST(SceneKeys, OfAFemBody) {
  const Body& soft = full().bodies[0];
  EXPECT_EQ(soft.kind, BodyKind::fem);
  EXPECT_EQ(std::get<BoxShape>(std::get<Shape>(soft.geometry)).half, (Point3{1, 2, 3}));
  EXPECT_EQ(soft.lattice->cells, (std::array<std::int64_t, 3>{2, 4, 6}));
  EXPECT_EQ(std::get<std::int64_t>(soft.surface), 500);
  EXPECT_EQ(soft.material.youngs_modulus, 1e5);
  EXPECT_EQ(soft.material.poissons_ratio, 0.4);
  EXPECT_EQ(soft.material.density, 950);
  EXPECT_EQ(soft.damping.alpha, 0.5);
  EXPECT_EQ(soft.damping.gamma, 1e-3);
  EXPECT_EQ(soft.mass, MassKind::lumped);
  EXPECT_TRUE(soft.cage_start);
  EXPECT_FALSE(soft.collide);
  EXPECT_EQ(soft.self, true);
  EXPECT_EQ(soft.pose.position, (Point3{4, 5, 6}));
  EXPECT_NEAR(soft.pose.rotation[0], 0, 1e-15);
  EXPECT_NEAR(soft.pose.rotation[3], 1, 1e-15);
  EXPECT_EQ(soft.velocity, (Point3{7, 8, 9}));
  EXPECT_EQ(soft.angular_velocity, (Point3{0.1, 0.2, 0.3}));
  EXPECT_EQ(std::get<BoxSelection>(soft.fixed.at(0)).high, (Point3{9, 9, 3.5}));
  EXPECT_EQ(std::get<HalfSpaceSelection>(soft.driven.at(0).select.at(0)).offset, 8.5);
  EXPECT_EQ(soft.driven[0].path.at(1).displacement, (Point3{0, 0, 2}));
}

TEST(SceneKeys, OfRigidBodiesAndCloth) {
  const Body& stone = full().bodies[1];
  EXPECT_EQ(stone.rigid.mass, 3);
  EXPECT_EQ(stone.rigid.inertia, (std::array<double, 6>{1, 1.5, 2, 0.1, 0.2, 0.3}));
  EXPECT_EQ(stone.pose.rotation, (std::array<double, 4>{0, 0, 1, 0}));
  EXPECT_EQ(full().bodies[2].rigid.density, 1300);
  const Body& flag = full().bodies[3];
  const auto& sheet = std::get<Sheet>(flag.geometry);
  EXPECT_EQ(sheet.size, (std::array<double, 2>{1, 2}));
  EXPECT_EQ(sheet.cells, (std::array<std::int64_t, 2>{3, 4}));
  EXPECT_EQ(sheet.origin, (Point3{5, 6, 7}));
  EXPECT_EQ(sheet.axes[1], (Point3{0, 0, 1})) << "axes become unit vectors";
  EXPECT_EQ(flag.cloth.areal_density, 0.3);
  EXPECT_EQ(flag.cloth.stretch, 400);
  EXPECT_EQ(flag.cloth.shear, 80);
  EXPECT_EQ(flag.cloth.bend, 2e-4);
  EXPECT_EQ(std::get<SphereSelection>(flag.fixed.at(0)).radius, 0.5);
  EXPECT_EQ(std::get<NodeSelection>(flag.fixed.at(1)).nodes, (std::vector<std::int64_t>{0, 3}));
  EXPECT_TRUE(std::holds_alternative<AllSelection>(flag.fixed.at(2)));
}

TEST(SceneKeys, OfScriptedBodies) {
  const auto& hinge = std::get<Hinge>(full().bodies[4].motion);
  EXPECT_EQ(hinge.point, (Point3{0, 0, 1}));
  EXPECT_EQ(hinge.axis, (Point3{1, 0, 0}));
  EXPECT_EQ(hinge.angle.at(1), (std::array<double, 2>{1, 0.5}));
  EXPECT_TRUE(std::holds_alternative<std::monostate>(full().bodies[4].geometry));
  const auto& wave = std::get<Wave>(full().bodies[5].motion);
  EXPECT_EQ(wave.axis, 2);
  EXPECT_EQ(wave.lateral, 1);
  EXPECT_EQ(wave.frequency, 2);
  EXPECT_EQ(wave.wavelength, 0.5);
  EXPECT_EQ(wave.phase, 0.125);
  EXPECT_EQ(wave.envelope, (std::array<double, 3>{0.02, -0.08, 0.16}));
  EXPECT_EQ(full().bodies[5].lattice->edge, 0.5);
  const auto& path = std::get<Path>(full().bodies[6].motion);
  EXPECT_EQ(path.at(0).displacement, (Point3{1, 2, 3}));
  EXPECT_EQ(path.at(0).axis_angle, (Point3{0.1, 0.2, 0.3}));
}

TEST(SceneKeys, OfShapes) {
  const auto shape = [](std::size_t body) { return std::get<Shape>(full().bodies[body].geometry); };
  EXPECT_EQ(std::get<EllipsoidShape>(shape(1)).radii, (Point3{0.5, 0.5, 0.5}));
  EXPECT_EQ(std::get<EllipsoidShape>(shape(2)).radii, (Point3{1, 2, 3}));
  EXPECT_EQ(std::get<CapsuleShape>(shape(5)).radius, 0.25);
  EXPECT_EQ(std::get<CapsuleShape>(shape(5)).length, 2);
  EXPECT_EQ(std::get<TorusShape>(shape(6)).tube, 0.25);
  EXPECT_EQ(std::get<ArcShape>(shape(7)).angles, (std::array<double, 2>{0.2, 2.2}));
  EXPECT_EQ(full().bodies[7].lattice->tets, 90);
  const auto strip = std::get<BentStripShape>(shape(8));
  EXPECT_EQ(strip.width, 0.06);
  EXPECT_EQ(strip.height, 0.012);
  EXPECT_EQ(strip.depth, 0.014);
  EXPECT_EQ(strip.sag, -0.008);
  EXPECT_EQ(std::get<PlateShape>(shape(9)).size, (Point3{0.1, 0.12, 0.012}));
  EXPECT_EQ(std::get<CylinderShape>(shape(10)).length, 2);
}

/// Elliptical cylinders with ends: pi a b (length + 2/3 of both ends).
TEST(SceneKeys, OfLofts) {
  const Body &bone = full().bodies[12], &muscle = full().bodies[13];
  const double area = std::numbers::pi * 0.1 * 0.2;
  const auto& bones = std::get<Surface>(bone.geometry);
  Bounds bounds;
  for (const Point3& x : bones.points) bounds.include(x);
  EXPECT_NEAR(bounds.low[0], -0.3, 1e-12);  // the end of the first tube
  EXPECT_NEAR(bounds.high[0], 1.4, 1e-12);
  EXPECT_NEAR(bounds.low[2], -0.2, 0.03);  // the second radius of the first tube
  EXPECT_NEAR(bounds.high[1], 0.1, 0.03);
  EXPECT_NEAR(double(bones.triangles.size()), 400, 80);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(bone.surface));

  const auto& mesh = std::get<Mesh>(muscle.geometry);
  EXPECT_EQ(mesh.tets.size(), 120U);
  EXPECT_FALSE(muscle.lattice);
  double volume = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    const std::vector<Point3>& x = mesh.rest_positions;
    volume += tet_volume(at(x, a), at(x, b), at(x, c), at(x, d));
  }
  // The tetrahedra around the tube have its mass, and of its stiffness as much.
  const double exact = area * (1 + 2 / 3. * (0.1 + 0.1));
  EXPECT_NEAR(muscle.material.density * volume / (500 * exact), 1, 1e-12);
  EXPECT_NEAR(muscle.material.youngs_modulus * volume / (2e5 * exact), 1, 1e-12);
  EXPECT_NEAR(double(std::get<Surface>(muscle.surface).triangles.size()), 400, 80);
}

TEST(SceneKeys, OfAPhantomAndATransferTable) {
  const Body& fruit = full().bodies[11];
  const auto& image = std::get<ImageGeometry>(fruit.geometry);
  EXPECT_EQ(image.volume.grid.dims, (std::array<std::int64_t, 3>{8, 9, 10}));
  EXPECT_EQ(image.volume.grid.spacing, (Point3{0.01, 0.02, 0.03}));
  EXPECT_EQ(image.volume.grid.origin, (Point3{1, 2, 3}));
  EXPECT_EQ(image.threshold, 0.25);
  EXPECT_EQ(fruit.lookup, TransferLookup::label);
  EXPECT_EQ(fruit.mean, MaterialMean::harmonic);
  EXPECT_EQ(fruit.transfer.at(1).value, 1);
  EXPECT_EQ(fruit.transfer.at(1).material.youngs_modulus, 4e5);
  EXPECT_EQ(fruit.transfer.at(1).material.poissons_ratio, 0.3);
  EXPECT_EQ(fruit.transfer.at(1).material.density, 1100);
  EXPECT_EQ(std::get<LabelSelection>(fruit.fixed.at(0)).value, 1);
}

TEST(SceneKeys, OfObstacles) {
  const auto& plane = std::get<PlaneObstacle>(full().obstacles[0].geometry);
  EXPECT_EQ(plane.normal, (Point3{0, 0, 2}));
  EXPECT_EQ(plane.point, (Point3{0, 0, -9}));
  EXPECT_EQ(full().obstacles[0].path.at(1).displacement, (Point3{0, 0, 1}));
  EXPECT_EQ(std::get<SphereObstacle>(full().obstacles[1].geometry).radius, 4);
  EXPECT_EQ(full().obstacles[1].name, "obstacle1");
  EXPECT_EQ(std::get<CapsuleObstacle>(full().obstacles[2].geometry).to, (Point3{4, 5, 6}));
}

TEST(SceneKeys, OfCouplingsHandlesAndLoads) {
  const Coupling& tie = full().couplings[0];
  EXPECT_EQ(tie.a + tie.b, "softjaw");
  EXPECT_EQ(tie.within, 0.5);
  EXPECT_EQ(tie.stiffness, 1e4);
  EXPECT_EQ(tie.damping, 3);
  EXPECT_TRUE(tie.collide);
  EXPECT_EQ(full().couplings[1].points.at(1), (Point3{1, 0, 0}));
  EXPECT_EQ(full().couplings[1].name, "stone-world");
  EXPECT_EQ(full().couplings[2].name, "stone-world-2");
  const Handle& handle = full().handles[0];
  EXPECT_EQ(handle.name, "soft");
  EXPECT_EQ(handle.stiffness, 500);
  EXPECT_EQ(handle.damping, 2);
  EXPECT_EQ(handle.path.at(1).displacement, (Point3{0.03, 0, 0}));
  EXPECT_FALSE(handle.path.at(2).displacement);
  EXPECT_EQ(full().handles[1].name, "grip");
  EXPECT_FALSE(full().handles[1].path.at(1).displacement);
  EXPECT_EQ(full().loads[0].force, (Point3{1, 2, 3}));
  EXPECT_EQ(full().loads[0].from, 0.1);
  EXPECT_EQ(full().loads[0].to, 0.2);
  EXPECT_EQ(full().loads[1].pressure, 100);
  EXPECT_EQ(full().loads[1].to, std::numeric_limits<double>::infinity());
}

TEST(SceneKeys, OfContactAreThoseOfTheSceneUnlessGiven) {
  const AdhesionMaterial& adhesion = full().contact.material.adhesion.value();
  EXPECT_EQ(adhesion.stiffness, 4e7);
  EXPECT_EQ(adhesion.tangential_stiffness, 3e7);
  EXPECT_EQ(adhesion.energy, 2);
  EXPECT_EQ(adhesion.viscosity, 0.05);
  EXPECT_EQ(adhesion.bonding_rate, 0.01);
  EXPECT_EQ(adhesion.saturation_pressure, 500);
  EXPECT_EQ(adhesion.initial_intensity, 0.5);
  EXPECT_EQ(full().bodies[0].contact->friction, 0.5);
  EXPECT_EQ(full().bodies[0].contact->adhesion->energy, 2);
  EXPECT_EQ(full().bodies[1].contact->friction, 0.25);
  EXPECT_FALSE(full().bodies[1].contact->adhesion);
  EXPECT_FALSE(full().bodies[2].contact);
  const ContactPairMaterial& pair = full().contact.pairs.at(0);
  EXPECT_EQ(pair.friction, 0.75);
  EXPECT_TRUE(pair.has_adhesion);
  EXPECT_FALSE(pair.adhesion);
  EXPECT_FALSE(pair.collide);
}
}  // namespace
}  // namespace tetwarp::test

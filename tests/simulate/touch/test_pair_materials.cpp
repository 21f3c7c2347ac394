/// @file test_pair_materials.cpp
/// Contact materials of pairs of bodies from those of the two.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "tests/simulate/touch_scenes.hpp"

namespace tetwarp::test {
namespace {

AdhesionMaterial glue(double energy, double stiffness) {
  AdhesionMaterial adhesion;
  adhesion.energy = energy;
  adhesion.stiffness = stiffness;
  adhesion.viscosity = 2;
  adhesion.bonding_rate = 3;
  adhesion.saturation_pressure = 4;
  adhesion.initial_intensity = 0.5;
  return adhesion;
}

Scene boxes(int count) {
  std::vector<Body> bodies;
  bodies.reserve(static_cast<std::size_t>(count));
  for (int b = 0; b < count; ++b) {
    bodies.push_back(rigid_box("box" + std::to_string(b), {0.1, 0.1, 0.1}, {1.0 * b, 0, 0}));
  }
  Scene scene = scene_of(bodies, 0.01);
  scene.obstacles = {{"floor", PlaneObstacle{{0, 0, 1}, {0, 0, -1}}, {}, {}}};
  return scene;
}

TEST(PairMaterials, FrictionIsTheGeometricMean) {
  Scene scene = boxes(3);
  scene.contact.material.friction = 0.3;
  scene.bodies[0].contact = SurfaceContact{0.2, {}};
  scene.bodies[1].contact = SurfaceContact{0.8, {}};
  const TouchScene touch(scene);

  EXPECT_NEAR(touch.material(0, 1).friction, 0.4, 1e-15);
  EXPECT_EQ(touch.material(1, 0).friction, touch.material(0, 1).friction);
  EXPECT_NEAR(touch.material(0, 2).friction, std::sqrt(0.06), 1e-15);
  EXPECT_EQ(touch.material(2, 3).friction, 0.3);  // both have the scene's
  EXPECT_EQ(touch.material(0, 0).friction, 0.2);
  EXPECT_EQ(touch.material(0, 1).stiffness, 0);
}

TEST(PairMaterials, AdhesionIsThatOfTheLowerEnergy) {
  Scene scene = boxes(4);
  scene.contact.material.adhesion = glue(5, 100);
  scene.bodies[0].contact = SurfaceContact{0, glue(2, 300)};
  scene.bodies[1].contact = SurfaceContact{0, glue(9, 50)};
  scene.bodies[2].contact = SurfaceContact{0, std::nullopt};
  const TouchScene touch(scene);

  const ContactMaterial& pair = touch.material(0, 1);
  EXPECT_EQ(std::tuple(pair.energy, pair.stiffness, pair.tangential_stiffness.value(),
                       pair.viscosity, pair.bonding_rate, pair.saturation_pressure,
                       pair.initial_intensity, pair.restitution),
            std::tuple(2.0, 300.0, 300.0, 2.0, 3.0, 4.0, 0.5, 0.0));
  EXPECT_EQ(touch.material(1, 3).energy, 5);
  EXPECT_EQ(touch.material(4, 1).energy, 5);  // the floor has the scene's
  EXPECT_EQ(touch.material(2, 3).stiffness, 0);
  EXPECT_EQ(touch.material(2, 3).energy, 0);
}

/// Of equal energies the choice does not depend on the order of the bodies.
TEST(PairMaterials, AreSymmetric) {
  Scene scene = boxes(2);
  scene.bodies[0].contact = SurfaceContact{0.1, glue(2, 300)};
  scene.bodies[1].contact = SurfaceContact{0.9, glue(2, 50)};
  const TouchScene touch(scene);
  EXPECT_EQ(touch.material(0, 1).stiffness, 50);
  EXPECT_EQ(touch.material(1, 0).stiffness, 50);
  EXPECT_EQ(touch.surfaces.material_of(0, 1), touch.surfaces.material_of(1, 0));
}

TEST(PairMaterials, PairsOverrideTheirPart) {
  Scene scene = boxes(4);
  scene.contact.material = {0.3, glue(5, 100)};
  scene.contact.pairs = {
      {.a = "box1", .b = "box0", .friction = 0.7},
      {.a = "box0", .b = "box2", .has_adhesion = true, .adhesion = glue(1, 7)},
      {.a = "floor", .b = "box0", .has_adhesion = true, .adhesion = std::nullopt},
      {.a = "box3", .b = "box3", .friction = 0.0, .has_adhesion = true},
      {.a = "box2", .b = "box3", .collide = false}};
  const TouchScene touch(scene);

  EXPECT_EQ(touch.material(0, 1).friction, 0.7);
  EXPECT_EQ(touch.material(0, 1).stiffness, 100);
  EXPECT_EQ(touch.material(2, 0).friction, 0.3);
  EXPECT_EQ(touch.material(2, 0).stiffness, 7);
  EXPECT_EQ(touch.material(0, 4).friction, 0.3);
  EXPECT_EQ(touch.material(0, 4).stiffness, 0);
  EXPECT_EQ(touch.material(3, 3).friction, 0);
  EXPECT_EQ(touch.material(3, 3).stiffness, 0);
  EXPECT_EQ(touch.material(1, 3).friction, 0.3);
  EXPECT_EQ(touch.material(1, 3).stiffness, 100);
}

/// Materials and classes are listed once: their number does not grow with that of the bodies.
TEST(PairMaterials, AreListedOnce) {
  Scene scene = boxes(50);
  for (std::size_t b = 0; b < 50; b += 2) scene.bodies[b].contact = SurfaceContact{0.5, {}};
  const TouchScene touch(scene);

  EXPECT_EQ(touch.surfaces.class_count, 2);
  EXPECT_EQ(touch.surfaces.materials.size(), 2U);  // 0.5 and 0
  EXPECT_TRUE(touch.surfaces.pair_materials.empty());
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_scene_shipped_contact.cpp
/// The scenes with contact that ship with the library: their bodies, before anything moves.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <tetwarp/simulate.hpp>
#include <variant>

#include "host/scene/scene_geometry.hpp"
#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
std::map<std::string, std::size_t> tet_counts(const Scene& scene) {
  const SceneGeometry geometry = make_scene_geometry(scene);
  std::map<std::string, std::size_t> counts;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    counts[scene.bodies[b].name] = geometry.bodies[b].tets.size();
  }
  return counts;
}

TEST(ShippedScenes, CandyHasTenThousandTetrahedraAndTwentySevenThousandTriangles) {
  const Scene candy = shipped("candy");
  const SceneGeometry geometry = make_scene_geometry(candy);
  ASSERT_EQ(candy.bodies.size(), 26U);
  std::size_t tets = 0, triangles = 0;
  for (std::size_t b = 0; b < candy.bodies.size(); ++b) {
    const std::size_t count = geometry.bodies[b].tets.size();
    tets += count;
    triangles += geometry.bodies[b].surface.triangles.size();
    const std::string& name = candy.bodies[b].name;
    const double wanted = name == "jello" ? 2880 : name.starts_with("candy") ? 475 : 0;
    EXPECT_NEAR(static_cast<double>(count), wanted, wanted == 475 ? 25 : 0) << name;
  }
  EXPECT_NEAR(static_cast<double>(tets), 1e4, 100);
  EXPECT_NEAR(static_cast<double>(triangles), 28e3, 1000);
}

TEST(ShippedScenes, CandyAdheresByKindAndDropsDoNot) {
  const Scene candy = shipped("candy");
  EXPECT_EQ(candy.contact.material.friction, 0.3);
  const std::map<std::string, double> energy{
      {"jello", 4}, {"candy0", 0.5}, {"candy1", 2}, {"candy2", 8}, {"candy3", 20}};
  for (const Body& body : candy.bodies) {
    if (const auto found = energy.find(body.name); found != energy.end()) {
      ASSERT_TRUE(body.contact && body.contact->adhesion) << body.name;
      EXPECT_EQ(body.contact->adhesion->energy, found->second) << body.name;
      EXPECT_EQ(body.contact->adhesion->stiffness, 4e7) << body.name;
      EXPECT_EQ(body.contact->friction, 0.3) << body.name;
    }
    const bool adheres = body.contact && body.contact->adhesion;
    EXPECT_EQ(adheres, body.kind == BodyKind::fem) << body.name;
  }
}

/// Closed forms: 4/3 pi abc, 2 pi^2 R r^2, 8 abc, times the density.
TEST(ShippedScenes, CandyHasTheMassesOfItsShapes) {
  Scene candy = shipped("candy");
  candy.bodies.resize(4);
  for (Body& body : candy.bodies) body.collide = false;
  const Simulator simulator(candy);
  const double pi = std::numbers::pi;
  const double jello = 1000 * 0.2 * 0.2 * 0.0666;
  const double ellipsoid = 1100 * 4 / 3. * pi * 0.016 * 0.012 * 0.012;
  const double torus = 1100 * 2 * pi * pi * 0.014 * 0.006 * 0.006;
  const double box = 1100 * 0.024 * 0.02 * 0.016;
  EXPECT_NEAR(simulator.body(0).mass / jello, 1, 1e-12);
  EXPECT_NEAR(simulator.body(1).mass / ellipsoid, 1, 1e-3);
  EXPECT_NEAR(simulator.body(2).mass / torus, 1, 1e-3);
  EXPECT_NEAR(simulator.body(3).mass / box, 1, 1e-12);
}

TEST(ShippedScenes, OrangesHaveTheMassOfTheirImage) {
  Scene oranges = shipped("oranges");
  ASSERT_EQ(oranges.bodies.size(), 6U);
  EXPECT_NEAR(std::atan2(oranges.gravity[0], -oranges.gravity[2]) * 180 / std::numbers::pi, 3,
              1e-5);
  oranges.bodies.resize(1);
  oranges.bodies[0].collide = false;
  const Simulator simulator(oranges);
  const BodyMesh& orange = simulator.body(0);
  EXPECT_EQ(orange.mesh.tets.size(), 154U);
  EXPECT_NEAR(static_cast<double>(orange.surface.points.size()), 1600, 50);

  const auto& image = std::get<ImageGeometry>(oranges.bodies[0].geometry);
  const std::vector<TransferPoint>& table = oranges.bodies[0].transfer;
  long double mass = 0;
  for (const float sample : image.volume.samples<float>()) {
    const double value = sample;
    if (value < image.threshold) continue;
    // The density changes between the second and the third entry of the table only.
    const double part =
        std::min(std::max((value - table[1].value) / (table[2].value - table[1].value), 0.), 1.);
    mass += 4e-4 * 4e-4 * 5e-4 * (950 + part * (1100 - 950));
  }
  EXPECT_NEAR(orange.mass / static_cast<double>(mass), 1, 1e-12);
}

/// The paper's eleven parts and 16 couplings, a clavicle and a deltoid with three more, and two
/// fingers with the spring between them.
TEST(ShippedScenes, ShoulderHasItsPartsCouplingsAndFingers) {
  const Scene shoulder = shipped("shoulder");
  const std::map<std::string, std::size_t> wanted{
      {"supraspinatus", 80},  {"infraspinatus", 120},   {"subscapularis", 160},
      {"coracoacromial", 60}, {"coracohumeral", 80},    {"labrum", 96},
      {"labrum_tendon", 120}, {"deltoid", 120},         {"scapula", 0},
      {"humerus", 0},         {"clavicle", 0},          {"biceps_tendon", 0},
      {"finger_inside", 0},   {"transversehumeral", 0}, {"finger_outside", 0}};
  EXPECT_EQ(shoulder.bodies.size(), wanted.size());
  EXPECT_EQ(shoulder.couplings.size(), 20U);
  for (const auto& [name, count] : tet_counts(shoulder)) {
    EXPECT_NEAR(static_cast<double>(count), static_cast<double>(wanted.at(name)),
                name == "labrum" ? 7 : 0)
        << name;
  }
}

TEST(ShippedScenes, MouthOpensByTwentyDegrees) {
  const Scene mouth = shipped("mouth");
  const auto counts = tet_counts(mouth);
  EXPECT_EQ(counts.at("upper"), 630U);
  EXPECT_EQ(counts.at("lower"), 630U);
  const auto& hinge = std::get<Hinge>(mouth.bodies.at(2).motion);
  EXPECT_NEAR(hinge.angle.back()[1] * 180 / std::numbers::pi, 20, 1e-4);
}

TEST(ShippedScenes, ClothHangsBesideAWallToWhichItSticksOrNot) {
  for (const auto& [name, energy] : {std::pair{"cloth", 0.6}, std::pair{"cloth_peels", 0.01}}) {
    const Scene scene = shipped(name);
    EXPECT_EQ(scene.contact.material.adhesion->energy, energy);
    const Simulator simulator(scene);
    EXPECT_NEAR(simulator.body(0).mass, 0.3, 1e-12);
    EXPECT_EQ(simulator.body(0).surface.points.size(), 441U);
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_touch_edges.cpp
/// A box that stands with one of its edges on an edge of another box.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/simulate/touch_judge.hpp"

namespace tetwarp::test {
namespace {
constexpr double half = 0.05;       // of the boxes' edges [m]
constexpr double thickness = 1e-3;  // [m]
constexpr double mass = 1;          // of a box at 1000 kg/m^3 [kg]

/// A box's pose with an edge of direction (cos angle, sin angle, 0) on top and one at the bottom.
Pose on_edge(double angle, double height) {
  const double x = std::numbers::pi / 8, z = angle / 2;
  return {{0, 0, height},
          {std::cos(z) * std::cos(x), std::cos(z) * std::sin(x), std::sin(z) * std::sin(x),
           std::sin(z) * std::cos(x)}};
}

struct Stand {
  double carried = 0;  ///< over the upper body's weight
  std::int64_t contacts = 0;
  bool converged = true;
};

/// The last of `steps` of 1 ms; judges all of them.
Stand stand(Body upper, double angle, int steps) {
  Body lower = rigid_box("lower", {half, half, half}, {0, 0, 0});
  lower.kind = BodyKind::scripted;
  lower.lattice = Lattice{.cells = {{1, 1, 1}}};
  const double diagonal = half * std::numbers::sqrt2;
  lower.pose = on_edge(angle, -diagonal);
  lower.motion = Path{{0, Point3{0, 0, 0}}, {10, Point3{0, 0, 0}}};
  upper.pose = on_edge(0, diagonal + 1.2 * thickness);
  Scene scene = scene_of({lower, upper}, 1e-3);
  scene.thickness = thickness;
  scene.contact.material.friction = 0.5;
  Simulator simulator(scene);
  Judge judge(simulator);
  Stand result;
  for (int n = 0; n < steps; ++n) {
    simulator.step();
    judge.expect_apart();
    const StepRecord& record = simulator.record();
    result.carried = record.bodies[1].contact_force[2] / (-mass * scene.gravity[2]);
    result.contacts = record.contacts;
    result.converged = result.converged && record.converged;
  }
  return result;
}

/// Crossed at a right angle, and almost parallel.
TEST(EdgeOnEdge, CarriesTheWeight) {
  for (const double angle : {std::numbers::pi / 2, std::numbers::pi / 180}) {
    const Stand rigid = stand(rigid_box("upper", {half, half, half}, {0, 0, 0}), angle, 40);
    EXPECT_NEAR(rigid.carried, 1, 0.01) << angle;
    EXPECT_GE(rigid.contacts, 1) << angle;
    EXPECT_TRUE(rigid.converged) << angle;

    Body soft = elastic_box("upper", {half, half, half}, {2, 2, 2});
    soft.material.youngs_modulus = 1e7;
    soft.damping = {5, 1e-3};
    const Stand elastic = stand(soft, angle, 100);
    EXPECT_NEAR(elastic.carried, 1, 0.01) << angle;
    EXPECT_TRUE(elastic.converged) << angle;
  }
}

}  // namespace
}  // namespace tetwarp::test

/// Chains and cloth that hang at rest, on the reference.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/body_scenes.hpp"

namespace tetwarp::test {
namespace {

constexpr double gravity = 9.81;

/// Eight boxes below one another, 0.2 m apart; each hangs by one spring between the middle of its
/// top and that of the bottom of the one above, the first from a point of the world.
Scene chain_scene(double stiffness, double time_step) {
  Scene scene = scene_of(time_step, 1, {0, 0, -gravity});
  for (int i = 0; i < 8; ++i) {
    Body box = rigid_box("box" + std::to_string(i), {0.05, 0.05, 0.1}, 500);
    box.damping.alpha = 0.3 * std::sqrt(stiffness);  // the slowest mode, 0.18 sqrt(k/m), fades
    box.pose.position = {0, 0, -0.1 - 0.2 * i};
    scene.bodies.push_back(box);
    Coupling spring;
    spring.a = box.name;
    spring.b = i == 0 ? "world" : "box" + std::to_string(i - 1);
    spring.points = {{0, 0, -0.2 * i}};
    spring.stiffness = stiffness;
    scene.couplings.push_back(spring);
  }
  return scene;
}

TEST(ReferenceHanging, ChainStretchesEverySpringByTheWeightBelowIt) {
  for (const double stiffness : {1e3, 1e5, 1e7, 1e9}) {
    const SceneBodies chain(chain_scene(stiffness, 8e-3));
    auto bodies = chain.bodies();

    for (int step = 0; step < 600; ++step) bodies.step();

    const StepRecord record = bodies.record();
    const double weight = 1000 * 0.5 * 0.1 * 0.1 * 0.2 * gravity;
    double above = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const double top = record.bodies[i].center[2] + 0.1;
      const double gap = above - top, expected = weight * static_cast<double>(8 - i) / stiffness;
      // Positions are rounded to 1e-16 of a meter.
      EXPECT_NEAR(gap, expected, 1e-7 * expected + 1e-15) << stiffness << ' ' << i;
      above = record.bodies[i].center[2] - 0.1;
    }
  }
}

/// Parameter a of the catenary of a length over a span: 2 a sinh(span / (2 a)) = length.
double catenary_parameter(double span, double length) {
  double low = 0.01, high = 100;
  for (int i = 0; i < 200; ++i) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(span / (2 * a)) > length ? low : high) = a;
  }
  return low;
}

/// Largest distance of a hanging strip of cloth, 1.3 m long over 1 m, from its catenary. It starts
/// on it, so that inaccuracies move it by as much as they are.
double catenary_error(std::int64_t segments) {
  constexpr double span = 1, length = 1.3, width = 0.1, areal_density = 0.3;
  const double weight = areal_density * width * length * gravity;
  Scene scene = scene_of(0.1, 1, {0, 0, -gravity});
  Cloth cloth{areal_density, 1e5 * weight / width, 0, 0};
  Body strip = sheet_body("strip", {length, width}, {segments, 1}, cloth);
  strip.damping.alpha = 2;
  scene.bodies = {strip};
  SceneBodies hanging(scene);
  BodyGeometry& geometry = hanging.geometry.bodies[0];
  geometry.fixed =
      nodes_where(geometry, [](const Point3& x) { return x[0] < 1e-9 || x[0] > length - 1e-9; });
  const double a = catenary_parameter(span, length);
  std::vector<Point3> exact;
  for (const Point3& x : geometry.nodes) {
    const double arc = x[0] - length / 2, along = a * std::asinh(arc / a);
    exact.push_back({along, x[1], a * std::cosh(along / a)});
  }
  auto bodies = hanging.bodies();
  set_nodes(bodies, exact, std::vector<Point3>(exact.size()));

  for (int step = 0; step < 150; ++step) bodies.step();

  return largest_distance(bodies.node_positions(0), exact);
}

TEST(ReferenceHanging, ClothFollowsTheCatenaryToSecondOrder) {
  const double at_8 = catenary_error(8), at_16 = catenary_error(16), at_32 = catenary_error(32);

  EXPECT_LT(at_8, 5e-3);
  EXPECT_LT(at_16, 1.3e-3);
  EXPECT_LT(at_32, 3.3e-4);
  EXPECT_GT(std::log2(at_8 / at_16), 1.8);
  EXPECT_GT(std::log2(at_16 / at_32), 1.8);
}

}  // namespace
}  // namespace tetwarp::test

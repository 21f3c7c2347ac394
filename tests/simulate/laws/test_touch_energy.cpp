/// The energy of soft bodies that fall onto each other, stick and rest.
#include <cmath>

#include "tests/simulate/touch_run.hpp"

namespace tetwarp::test {
namespace {

/// Three soft balls dropped on a soft block one after the other, with friction and adhesion. From
/// the moment on at which all have been let go, nothing acts from outside: the total energy, that
/// of bonds included, must not grow.
TEST(Energy, OfDroppedSoftBodiesDoesNotGrow) {
  Body block = elastic_box("block", {0.1, 0.1, 0.03}, {4, 4, 1});
  block.pose.position = {0, 0, 0.0302};
  block.material = {2e4, 0.4, 1000};
  std::vector<Body> bodies{block};
  const Point3 places[3] = {{-0.03, 0.01, 0.11}, {0.04, 0, 0.16}, {0, 0.01, 0.22}};
  for (std::size_t k = 0; k < 3; ++k) {
    Body ball = elastic_ball("ball" + std::to_string(k), 0.03, places[k]);
    ball.lattice = Lattice{.cells = {{3, 3, 3}}};
    ball.surface = std::int64_t{160};
    ball.material = {3e4, 0.4, 1000};
    bodies.push_back(ball);
  }
  Scene scene = scene_of(bodies, 0.008);
  scene.obstacles = {plane_at(0)};
  scene.thickness = 2e-4;
  scene.solver.linear_tolerance = 1e-6;
  scene.contact.material = {0.3, AdhesionMaterial{.stiffness = 1e6,
                                                  .energy = 0.5,
                                                  .viscosity = 0.01,
                                                  .bonding_rate = 1e-3,
                                                  .saturation_pressure = 200}};
  Simulator simulator(scene);
  const double lowest_possible = -1e-3;  // [J] of gravity on the floor and of bonds
  const double start = simulator.record().energy.total();
  double least = start, gain = 0, climb = 0;
  for (int n = 0; n < 150; ++n) {
    const double before = simulator.record().energy.total();
    simulator.step();
    const double now = simulator.record().energy.total();
    ASSERT_TRUE(std::isfinite(now));
    gain = std::max(gain, now - before);
    climb = std::max(climb, now - least);
    least = std::min(least, now);
    EXPECT_EQ(simulator.record().inverted, 0);
  }
  EXPECT_GT(simulator.record().contacts, 30);
  EXPECT_GT(simulator.record().adhered_area, 0);
  EXPECT_LE(gain, 1e-4 * start);   // of a step: rotations are held within it
  EXPECT_LE(climb, 3e-4 * start);  // above any earlier energy
  EXPECT_LT(least, 0.9 * start);
  EXPECT_GT(least, lowest_possible);
  RecordProperty("largest_gain_of_a_step", std::to_string(gain / start));
  RecordProperty("largest_climb", std::to_string(climb / start));
}

}  // namespace
}  // namespace tetwarp::test

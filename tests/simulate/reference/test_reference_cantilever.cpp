/// A clamped beam under its own weight against Timoshenko's, on the reference and on the cpu.
#include <gtest/gtest.h>

#include <cmath>
#include <tetwarp/simulate.hpp>

#include "tests/support/body_scenes.hpp"
#include "tests/support/cantilever.hpp"

namespace tetwarp::test {
namespace {

/// Deflection of the tip over that of the beam.
double reference_ratio(std::int64_t across, double poissons_ratio) {
  const Cantilever cantilever{across, poissons_ratio};
  const SceneBodies beam(cantilever.scene());
  auto bodies = beam.bodies();

  bodies.step();

  return -Cantilever::tip_height(beam.geometry.bodies[0].nodes, bodies.node_positions(0)) /
         cantilever.beam_tip();
}

double simulator_ratio(std::int64_t across, double poissons_ratio) {
  const Cantilever cantilever{across, poissons_ratio};
  Scene scene = cantilever.scene();
  scene.solver.linear_tolerance = 1e-9;
  SimulateOptions options;
  options.backend = Backend::cpu;
  Simulator simulator(scene, options);
  const std::vector<Point3> rest = simulator.node_positions(0);

  simulator.step();

  EXPECT_TRUE(simulator.record().converged);
  return -Cantilever::tip_height(rest, simulator.node_positions(0)) / cantilever.beam_tip();
}

// Expected values are those of an independent float64 solve of the same lattices.
TEST(ReferenceCantilever, SagsAsFarAsItsMeshLets) {
  EXPECT_NEAR(reference_ratio(1, 0), 0.3245, 0.01 * 0.3245);
  EXPECT_NEAR(reference_ratio(2, 0), 0.6416, 0.01 * 0.6416);
  EXPECT_NEAR(reference_ratio(1, 0.3), 0.3521, 0.01 * 0.3521);
  EXPECT_NEAR(reference_ratio(2, 0.3), 0.6685, 0.01 * 0.6685);
  EXPECT_NEAR(reference_ratio(1, 0.45), 0.3184, 0.01 * 0.3184);
  EXPECT_NEAR(reference_ratio(2, 0.45), 0.6254, 0.01 * 0.6254);
}

TEST(SimulatorCantilever, SagsAsTheReferenceDoes) {
  EXPECT_NEAR(simulator_ratio(1, 0.3), reference_ratio(1, 0.3), 1e-6);
  EXPECT_NEAR(simulator_ratio(2, 0.45), reference_ratio(2, 0.45), 1e-6);
}

TEST(SimulatorCantilever, ApproachesTheBeamWithItsCells) {
  const double at_4 = simulator_ratio(4, 0), at_8 = simulator_ratio(8, 0);

  EXPECT_NEAR(at_4, 0.8768, 0.01 * 0.8768);
  EXPECT_NEAR(at_8, 0.9660, 0.01 * 0.9660);
  EXPECT_NEAR(simulator_ratio(4, 0.3), 0.8823, 0.01 * 0.8823);
  EXPECT_NEAR(simulator_ratio(4, 0.45), 0.8494, 0.01 * 0.8494);
  EXPECT_GE(std::log2((1 - at_4) / (1 - at_8)), 1.5);
}

double tip_after(double time, double time_step) {
  const Cantilever cantilever{1, 0.3, 9.81, time_step};
  Scene scene = cantilever.scene();
  scene.bodies[0].damping.gamma = 2e-3;  // of the waves that a time step cannot resolve
  const SceneBodies beam(scene);
  auto bodies = beam.bodies();
  const auto steps = static_cast<int>(std::lround(time / time_step));
  for (int step = 0; step < steps; ++step) bodies.step();
  return Cantilever::tip_height(beam.geometry.bodies[0].nodes, bodies.node_positions(0));
}

TEST(ReferenceCantilever, ConvergesWithFirstOrderInTime) {
  const double at_8 = tip_after(0.08, 8e-3), at_4 = tip_after(0.08, 4e-3);
  const double at_2 = tip_after(0.08, 2e-3), at_1 = tip_after(0.08, 1e-3);

  for (const double ratio : {(at_8 - at_4) / (at_4 - at_2), (at_4 - at_2) / (at_2 - at_1)}) {
    EXPECT_GE(std::log2(ratio), 0.9);
    EXPECT_LE(std::log2(ratio), 1.05);
  }
}

}  // namespace
}  // namespace tetwarp::test

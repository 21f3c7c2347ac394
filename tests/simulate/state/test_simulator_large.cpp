/// A million tetrahedra.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>

#include "tests/simulate/simulate_scenes.hpp"

namespace tetwarp::test {
namespace {

/// Two steps of a hanging block of 1,080,000 tetrahedra in less than 6 GB.
TEST(SimulatorLarge, StepsAMillionTetrahedra) {
  Body block = elastic_box("block", {0.5, 0.5, 0.5}, {60, 60, 60});
  block.fixed = {HalfSpaceSelection{{0, 0, 1}, 0.499}};
  block.material.youngs_modulus = 1e4;
  Scene scene = scene_of({block}, 0.001);
  scene.solver.linear_tolerance = 1e-6;
  Simulator simulator(scene);
  run(simulator, 2);
  const StepRecord& record = simulator.record();

  EXPECT_EQ(simulator.body(0).mesh.tets.size(), 1'080'000U);
  EXPECT_TRUE(record.converged);
  EXPECT_EQ(record.inverted, 0);
  EXPECT_NEAR(simulator.body(0).mass, 1000, 1e-9);
  EXPECT_NEAR(record.bodies[0].center[2], -9.81e-6 * 3, 3e-7);  // all but the fixed layer falls
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  EXPECT_LT(usage.ru_maxrss, 6L << 20);  // [KiB]
}

}  // namespace
}  // namespace tetwarp::test

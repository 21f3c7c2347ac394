/// @file test_contact_stress_stacks.cpp
/// Stacks of 10 and 30 blocks with masses up to a million times each other's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/block_scenes.hpp"

namespace tetwarp::test {
namespace {
struct StackRun {
  double worst_eta = 0;
  double sink = 0;  ///< of the top block over its edge
  bool is_finite = true;
};

/// A stack released at rest, the top block `ratio` times as heavy as the lowest.
StackRun resting_stack(int count, double ratio, std::int64_t sweeps, int steps) {
  WorldOptions options = world_options({.friction = 0.5}, 5e-3);
  options.solving.tolerance = 1e-6;
  options.solving.max_sweeps = sweeps;
  RigidWorld world = stacked_blocks(options, count, std::pow(ratio, 1.0 / (count - 1)));
  const double height = world.boxes.back().pose.position[2];
  StackRun run;
  for (int step = 0; step < steps; ++step) {
    run.worst_eta = std::max(run.worst_eta, world.step().report.residual.eta);
  }
  run.sink = (height - world.boxes.back().pose.position[2]) / block_edge;
  run.is_finite = std::isfinite(run.sink) && std::isfinite(world.kinetic_energy());
  return run;
}

/// Law: a stack at rest that is solved to eta 1e-6 stays at rest for any masses: in 5 steps (a free
/// fall of 0.03 edges) the top moves by less than 1e-5 edges.
TEST(ContactStress, SolvedStacksStandWhateverTheMasses) {
  int solved = 0;
  for (const int count : {10, 30}) {
    for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
      const StackRun run = resting_stack(count, ratio, 5000, 5);

      EXPECT_TRUE(run.is_finite);
      if (run.worst_eta <= 1e-6) {
        ++solved;
        EXPECT_LT(std::abs(run.sink), 1e-5) << count << " " << ratio;
      }
    }
  }
  EXPECT_GT(solved, 0);
}

/// With 10 sweeps per step only finite numbers are required.
TEST(ContactStress, StacksSolvedByFewSweepsStayFinite) {
  for (const int count : {10, 30}) {
    for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
      EXPECT_TRUE(resting_stack(count, ratio, 10, 40).is_finite) << count << " " << ratio;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

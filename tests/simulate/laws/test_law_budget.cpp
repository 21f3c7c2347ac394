/// @file test_law_budget.cpp
/// Steps whose wall time is limited: what they keep, and what they say.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include "tests/simulate/crossing.hpp"
#include "tests/simulate/law_scenes.hpp"

namespace tetwarp::test {
namespace {

/// A soft and a rigid box that are thrown at each other above a floor, off their centers.
Scene clash() {
  Body soft = elastic_box("soft", {0.05, 0.05, 0.05}, {4, 4, 4});
  soft.pose.position = {-0.06, 0, 0.055};
  soft.velocity = {3, 0, -1};
  Body hard = rigid_box("hard", {0.04, 0.04, 0.04}, {0.05, 0.02, 0.05});
  hard.velocity = {-3, 0, 0.5};
  hard.angular_velocity = {0, 20, 5};
  Scene scene = floor_scene({soft, hard}, 0.005, 0.4);
  scene.solver.contact_tolerance = 1e-4;
  scene.solver.linear_tolerance = 1e-6;
  return scene;
}

Surface surface_of(const Simulator& simulator, std::size_t body) {
  return {simulator.surface_positions(body), simulator.body(body).surface.triangles};
}

TEST(StepBudget, ThatIsNotUsedUpChangesNoBit) {
  Simulator free(clash());
  Simulator limited(clash(), {.max_step_seconds = 1e6});
  run(free, 30);
  run(limited, 30);

  EXPECT_FALSE(limited.record().out_of_time);
  EXPECT_EQ(free.record().energy.total(), limited.record().energy.total());
  EXPECT_EQ(free.record().sweeps, limited.record().sweeps);
  for (std::size_t body = 0; body < 2; ++body) {
    EXPECT_EQ(free.surface_positions(body), limited.surface_positions(body));
  }
}

TEST(StepBudget, OfNoTimeKeepsSurfacesApart) {
  Simulator simulator(clash(), {.max_step_seconds = 1e-9});
  int late = 0;
  for (int n = 0; n < 60; ++n) {
    simulator.step();
    const StepRecord& record = simulator.record();
    late += record.out_of_time ? 1 : 0;
    EXPECT_EQ(record.substeps, 1) << "a step without time is not divided";
    EXPECT_GT(record.smallest_distance, 0) << n;
    EXPECT_EQ(crossing_count(surface_of(simulator, 0), surface_of(simulator, 1)), 0) << n;
    for (const Point3& x : simulator.surface_positions(0)) ASSERT_GT(x[2], 0) << n;
  }
  EXPECT_GT(late, 30);
}

/// What it says of a step is kept with the state.
TEST(StepBudget, IsRememberedByACheckpoint) {
  Simulator late(clash(), {.max_step_seconds = 1e-9});
  run(late, 10);
  ASSERT_TRUE(late.record().out_of_time);
  Simulator other(clash());
  other.restore(late.checkpoint());

  EXPECT_TRUE(other.record().out_of_time);
  run(other, 1);
  EXPECT_FALSE(other.record().out_of_time);
}

/// Steps that end by the clock in the middle of solves and divisions, whatever time these take
/// here.
TEST(StepBudget, IsRepeatedByItsCountsBitForBit) {
  Scene scene = clash();
  scene.solver.contact_tolerance = 1e-9;  // more to end
  for (const double seconds : {1e-9, 1e-4, 1e-3}) {
    Simulator timed(scene, {.threads = 1, .max_step_seconds = seconds});
    Simulator counted(scene, {.threads = 1, .max_step_seconds = 1});
    for (int n = 0; n < 40; ++n) {
      timed.step();
      const StepLimit limit = timed.step_limit();
      EXPECT_EQ(timed.record().out_of_time, limit.checks >= 0);
      counted.step(limit);
      EXPECT_EQ(counted.step_limit(), limit);
      ASSERT_EQ(counted.checkpoint(), timed.checkpoint()) << seconds << " s, step " << n;
    }
  }
}

/// Counts chosen by hand end a step anywhere, also where the clock would not.
TEST(StepBudget, MayEndAtAnyCount) {
  Simulator simulator(clash(), {.threads = 1, .max_step_seconds = 1e6});
  run(simulator, 15);  // they touch
  const std::vector<std::byte> start = simulator.checkpoint();
  simulator.step({});
  EXPECT_EQ(simulator.step_limit(), StepLimit{});
  const std::vector<std::byte> whole = simulator.checkpoint();
  int ended = 0;
  for (std::int64_t checks = 0; checks < 12; ++checks) {
    std::vector<std::byte> first;
    for (int n = 0; n < 2; ++n) {
      simulator.restore(start);
      simulator.step({.checks = checks});
      if (n == 0) first = simulator.checkpoint();
    }
    EXPECT_EQ(simulator.checkpoint(), first);
    EXPECT_EQ(simulator.record().out_of_time, first != whole);
    ended += simulator.record().out_of_time ? 1 : 0;
  }
  EXPECT_GT(ended, 4);
}

TEST(StepBudget, NeedsALimitToFollowCounts) {
  Simulator simulator(clash());
  EXPECT_THROW(simulator.step(StepLimit{}), std::invalid_argument);
}

TEST(StepBudget, HasToBePositive) {
  EXPECT_THROW(Simulator(clash(), {.max_step_seconds = 0}), std::invalid_argument);
  EXPECT_THROW(Simulator(clash(), {.max_step_seconds = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test

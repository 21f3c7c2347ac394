/// @file test_warp_in_flight.cpp
/// Steps begun before the last is finished: results and errors equal those of single steps. Records
/// of long series.
#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "tests/support/each_backend.hpp"
#include "tests/support/skip_series.hpp"
#include "tests/support/steps_in_flight.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class InFlight : public EachBackend {
 protected:
  const scenes::Scene scene = scenes::adversarial_scene("identity", 16);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::int16),
                                       scenes::wavy_volume(scene.source_grid, PixelType::float32)};
  const WarpOptions options = {.backend = GetParam()};

  /// Node positions that differ for each `step`.
  std::vector<Point3> shaken(std::uint64_t step) const {
    return scenes::waved(scene.deformed, 0.3 * scene.output_grid.spacing[0], step);
  }
};
INSTANTIATE_TEST_SUITE_P(Backends, InFlight, each_backend, name_of_backend);

TEST_P(InFlight, StepsHaveTheBitsOfStepsOneByOne) {
  const Steps steps = partial_motions(scene, 71);
  const std::vector<Bits> expected = steps_one_by_one(sources, scene, options, steps);

  for (const Pages pages : {Pages::pageable, Pages::locked}) {
    for (const bool holds_previous : {true, false}) {
      EXPECT_TRUE(steps_in_flight(sources, scene, options, steps, pages, holds_previous) ==
                  expected);
    }
  }
}

/// Results and sources of more than 4 MiB: a device copies memory that is not page-locked in
/// pieces.
TEST_P(InFlight, LargeResultsHaveTheSameBitsInLockedAndInPageableMemory) {
  const scenes::Scene large = scenes::adversarial_scene("waved", 40);
  const std::vector<Volume> tensors = {
      scenes::wavy_volume(large.source_grid, PixelType::float64, 9)};
  ASSERT_GT(tensors[0].data.size(), std::size_t{4} << 20);
  const Steps steps = {large.deformed, scenes::waved(large.deformed, 0.5, 1),
                       scenes::waved(large.deformed, 0.5, 2)};

  EXPECT_TRUE(steps_in_flight(tensors, large, options, steps, Pages::pageable, true) ==
              steps_in_flight(tensors, large, options, steps, Pages::locked, true));
}

/// The second of four steps has a node too far away, which is found only while it is computed.
TEST_P(InFlight, AnErrorIsThrownOnceByItsOwnStep) {
  Steps steps = {shaken(1), shaken(2), shaken(3), shaken(4)};
  const std::vector<Bits> expected = steps_one_by_one(sources, scene, options, steps);
  steps[1].front()[0] = 1e300;
  const StepBuffers buffers[] = {{sources, scene.output_grid, Pages::locked},
                                 {sources, scene.output_grid, Pages::locked}};
  Warper warper = make_warper(sources, scene, options);

  warper.begin_step(steps[0], buffers[0].target(true));
  EXPECT_NO_THROW(warper.begin_step(steps[1], buffers[1].target(true)));
  warper.finish_step();
  EXPECT_TRUE(buffers[0].bits() == expected[0]);
  EXPECT_NO_THROW(warper.begin_step(steps[2], buffers[0].target(true)));
  EXPECT_THROW(warper.finish_step(), std::invalid_argument);
  EXPECT_NO_THROW(warper.begin_step(steps[3], buffers[1].target(true)));
  warper.finish_step();
  EXPECT_TRUE(buffers[0].bits() == expected[2]);
  warper.finish_step();
  EXPECT_TRUE(buffers[1].bits() == expected[3]);
  EXPECT_EQ(warper.report().steps.size(), 3u);
}

TEST_P(InFlight, WhatCannotBeIsRefusedAndChangesNothing) {
  const StepBuffers a(sources, scene.output_grid, Pages::locked);
  const StepBuffers b(sources, scene.output_grid, Pages::locked);
  const StepBuffers c(sources, scene.output_grid, Pages::locked);
  Warper warper = make_warper(sources, scene, options);

  EXPECT_THROW(warper.finish_step(), std::logic_error);
  warper.begin_step(shaken(1), a.target(false));
  EXPECT_THROW(warper.begin_step(shaken(2), a.target(false)), std::invalid_argument);
  EXPECT_THROW(warper.step(shaken(2), b.target(false)), std::logic_error);
  warper.begin_step(shaken(2), b.target(false));
  EXPECT_THROW(warper.begin_step(shaken(3), c.target(false)), std::logic_error);
  EXPECT_EQ(warper.steps_in_flight(), Warper::max_steps_in_flight);
  warper.finish_step();
  warper.finish_step();

  const Steps steps = {shaken(1), shaken(2)};
  const std::vector<Bits> expected = steps_one_by_one(sources, scene, options, steps);
  EXPECT_TRUE(a.bits() == expected[0]);
  EXPECT_TRUE(b.bits() == expected[1]);
}

TEST_P(InFlight, AWarperMayEndWithStepsInFlight) {
  const StepBuffers a(sources, scene.output_grid, Pages::locked);
  const StepBuffers b(sources, scene.output_grid, Pages::locked);
  const Steps steps = {shaken(1), shaken(2)};
  const std::vector<Bits> expected = steps_one_by_one(sources, scene, options, steps);
  {
    Warper warper = make_warper(sources, scene, options);
    warper.begin_step(steps[0], a.target(false));
    warper.begin_step(steps[1], b.target(false));
  }
  EXPECT_TRUE(a.bits() == expected[0]);
}

/// So that memory does not grow with the length of a series; its sums hold all steps.
TEST(WarpRecords, AreThoseOfTheLastFiveHundredStepsAtLeast) {
  Mesh mesh;
  mesh.rest_positions = {{-1, -1, -1}, {5, -1, -1}, {-1, 5, -1}, {-1, -1, 5}};
  mesh.tets = {{0, 1, 2, 3}};
  const Volume voxel = make_volume(scenes::unit_grid(1, 1, 1), PixelType::uint8);
  Warper warper(voxel, mesh, {.backend = Backend::cpu, .threads = 1});

  for (std::int64_t step = 0; step < 1001; ++step) {
    run_step(warper, voxel, mesh.rest_positions);

    const Report& report = warper.report();
    ASSERT_EQ(report.steps.back().step, step);
    ASSERT_EQ(report.steps.front().step, step < 1000 ? 0 : 500);
    ASSERT_EQ(std::ssize(report.steps), step + 1 - report.steps.front().step);
    ASSERT_EQ(report.counts.covered, step + 1);
  }
}
}  // namespace
}  // namespace tetwarp::test

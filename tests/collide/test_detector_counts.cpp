/// @file test_detector_counts.cpp
/// Work and memory of a detection.
#include <gtest/gtest.h>

#include "tests/collide/collide_scenes.hpp"
#include "tests/collide/counted_memory.hpp"

namespace tetwarp::test {
namespace {
/// 20 bodies of 27,700 triangles.
CollideScene candy_like(const BodyFlags& flags = {}) {
  return pile_scene(20, 27700, flags);
}

TEST(DetectorCounts, ATriangleHasFewCellsAndFewTests) {
  const CollideScene scene = candy_like();
  const auto triangles = static_cast<double>(scene.surfaces.triangles.size());
  ASSERT_NEAR(triangles, 27700, 1500);
  const auto detector = make_cpu_detector(scene.surfaces, {});

  detector->detect(scene.motion);

  const DetectionCounts counts = detector->counts();
  const double kept = triangles - static_cast<double>(counts.skipped_items);
  EXPECT_GT(kept, 0.1 * triangles);
  EXPECT_LT(static_cast<double>(counts.grid_entries), 5 * kept);
  EXPECT_LT(static_cast<double>(counts.box_tests), 100 * triangles);
  EXPECT_GT(counts.pairs, 0);
}

/// All triangles are in the grid, and all pairs of a cell are tested.
TEST(DetectorCounts, ATriangleOfBodiesThatTouchThemselvesHasFewTests) {
  const CollideScene scene = candy_like({.touches_itself = true});
  const auto triangles = static_cast<double>(scene.surfaces.triangles.size());
  const auto detector = make_cpu_detector(scene.surfaces, {.skip_clear_bodies = false});

  detector->detect(scene.motion);

  const DetectionCounts counts = detector->counts();
  EXPECT_EQ(counts.skipped_items, 0);
  EXPECT_LT(static_cast<double>(counts.grid_entries), 5 * triangles);
  EXPECT_LT(static_cast<double>(counts.box_tests), 100 * triangles);
}

TEST(DetectorCounts, AddUpUntilRead) {
  const CollideScene scene = pile_scene(4, 1000);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->detect(scene.motion);
  const DetectionCounts once = detector->counts();
  EXPECT_EQ(detector->counts().box_tests, 0);

  for (int k = 0; k < 2; ++k) {
    detector->begin_step();
    detector->detect(scene.motion);
  }

  const DetectionCounts twice = detector->counts();
  EXPECT_EQ(twice.box_tests, 2 * once.box_tests);
  EXPECT_EQ(twice.grid_entries, 2 * once.grid_entries);
  EXPECT_EQ(twice.pairs, 2 * once.pairs);
  EXPECT_EQ(twice.evaluations, 2 * once.evaluations);
}

TEST(DetectorCounts, LaterStepsAllocateNothing) {
  const CollideScene scene = mixed_scene(3, 0.05);
  const auto detector = make_cpu_detector(scene.surfaces, {.threads = 2});
  const auto step = [&] {
    detector->begin_step();
    detector->detect(scene.motion);
    detector->detect(scene.motion);
    detector->check(scene.motion);
  };
  for (int k = 0; k < 2; ++k) step();
  const std::int64_t before = allocation_count();

  for (int k = 0; k < 3; ++k) step();

  EXPECT_EQ(allocation_count(), before);
}
}  // namespace
}  // namespace tetwarp::test

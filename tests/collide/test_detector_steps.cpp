/// @file test_detector_steps.cpp
/// Detections of one step after another, numbers of threads.
#include <gtest/gtest.h>

#include <random>

#include "tests/collide/collide_scenes.hpp"

namespace tetwarp::test {
namespace {
/// Three motions of a step that differ little, and a check.
std::vector<std::vector<TouchingPair>> step_results(const CollideScene& scene,
                                                    Detector& detector,
                                                    double change) {
  std::vector<std::vector<TouchingPair>> results;
  std::mt19937 random(9);
  CollideScene moved = scene;
  detector.begin_step();
  for (int pass = 0; pass < 3; ++pass) {
    results.push_back(detector.detect(moved.motion));
    for (std::int32_t b = 0; b < scene.body_count(); ++b) moved.shake_body(b, change, random);
  }
  results.push_back(detector.check(moved.motion));
  return results;
}

TEST(DetectorSteps, ReusedPairsGiveTheSameResults) {
  for (const double change : {1e-4, 0.3}) {
    const CollideScene scene = mixed_scene(5, 0.05);
    const auto with = make_cpu_detector(scene.surfaces, {.reuse_pairs = true});
    const auto without = make_cpu_detector(scene.surfaces, {.reuse_pairs = false});

    EXPECT_EQ(step_results(scene, *with, change), step_results(scene, *without, change));

    EXPECT_EQ(without->counts().reused, 0);
    EXPECT_EQ(with->counts().reused, change < 1e-3 ? 3 : 0);
  }
}

TEST(DetectorSteps, ANewStepForgetsThePairs) {
  CollideScene scene = mixed_scene(6, 0.05);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->detect(scene.motion);
  detector->begin_step();
  detector->detect(scene.motion);
  EXPECT_EQ(detector->counts().reused, 0);

  detector->check(scene.motion);

  EXPECT_EQ(detector->counts().reused, 1);
}

TEST(DetectorSteps, PairsAreTheSameForAnyNumberOfThreads) {
  const CollideScene scene = pile_scene(20, 6000, {.touches_itself = true});
  const auto one = make_cpu_detector(scene.surfaces, {.threads = 1});
  const auto expected = step_results(scene, *one, 1e-4);
  const DetectionCounts counts = one->counts();
  ASSERT_GT(expected[0].size(), 100u);

  for (const int threads : {2, 3, 8}) {
    const auto several = make_cpu_detector(scene.surfaces, {.threads = threads});
    EXPECT_EQ(step_results(scene, *several, 1e-4), expected);
    const DetectionCounts own = several->counts();
    EXPECT_EQ(own.box_tests, counts.box_tests);
    EXPECT_EQ(own.pairs, counts.pairs);
    EXPECT_EQ(own.evaluations, counts.evaluations);
  }
}
}  // namespace
}  // namespace tetwarp::test

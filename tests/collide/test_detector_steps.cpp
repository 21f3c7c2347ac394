/// @file test_detector_steps.cpp
/// Detections of one step after another, numbers of threads.
#include <gtest/gtest.h>

#include <random>

#include "host/collide/collide_items.hpp"
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

/// Later passes of a step need only what is hit on the way.
TEST(DetectorSteps, HitsAreTheDetectedPairsThatTouch) {
  for (const unsigned seed : {5u, 6u}) {
    const CollideScene scene = mixed_scene(seed, 0.05);
    const auto detector = make_cpu_detector(scene.surfaces, {});
    std::vector<TouchingPair> expected = detector->detect(scene.motion);
    const std::size_t all = expected.size();
    std::erase_if(expected, [](const TouchingPair& pair) { return pair.time > 1; });

    EXPECT_EQ(detector->detect_hits(scene.motion), expected);

    EXPECT_GT(expected.size(), 10u);
    EXPECT_LT(expected.size(), all);
  }
}

/// Runs of up to 32 vertices, then of up to 32 boxes, end in one per body that holds all of it.
TEST(CollideItems, EachBodyHasOneLastRun) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  const std::vector<std::int32_t> counts{1, 31, 32, 33, 1025, 1, 1024 * 32 + 1};
  for (const std::int32_t count : counts) {
    CollisionBody& body = scene.surfaces.bodies.emplace_back();
    body.first_vertex = static_cast<std::int32_t>(scene.surfaces.vertex_body.size());
    body.vertex_end = body.first_vertex + count;
    scene.surfaces.vertex_body.resize(static_cast<std::size_t>(body.vertex_end),
                                      scene.body_count() - 1);
    scene.surfaces.bodies.emplace_back();  // without vertices
  }
  scene.surfaces.vertex_radius.assign(scene.surfaces.vertex_body.size(), 1e-3);
  scene.surfaces.vertex_area.assign(scene.surfaces.vertex_body.size(), 0);
  const CollideItems made = make_collide_items(scene.surfaces);

  ASSERT_EQ(made.levels.size(), 5u);
  const std::vector<VertexRun> last(made.runs.begin() + made.levels[3], made.runs.end());
  ASSERT_EQ(last.size(), counts.size());
  for (std::size_t b = 0; b < counts.size(); ++b) {
    VertexRun run = last[b];
    EXPECT_EQ(run.body, 2 * static_cast<std::int32_t>(b));
    const auto at = [&](std::int32_t k) { return made.runs[static_cast<std::size_t>(k)]; };
    for (int level = 3; level > 0; --level) run = {at(run.begin).begin, at(run.end - 1).end, 0};
    const CollisionBody& body = scene.surfaces.bodies[2 * b];
    EXPECT_EQ(run.begin, body.first_vertex);
    EXPECT_EQ(run.end, body.vertex_end);
  }
  for (const VertexRun& run : made.runs) EXPECT_LE(run.end - run.begin, 32);
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

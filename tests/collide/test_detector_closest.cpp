/// @file test_detector_closest.cpp
/// The smallest distance of a scene.
#include <gtest/gtest.h>

#include "tests/collide/brute_force_pairs.hpp"

namespace tetwarp::test {
namespace {
/// Balls, a sheet and a capsule on a ground, the nearest a given distance apart.
CollideScene spaced_scene(double gap) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  scene.add_plane({{0, 0, 0}, {0, 0, 1}});
  scene.add_ball({0, 0, 0.5}, 0.2, 5, 9);
  scene.add_ball({0.6 + gap, 0, 0.5}, 0.2, 7, 9);
  scene.add_sheet({-0.5, -0.5, 0.85}, 1, 5);
  scene.add_capsule({-0.2, 0.4, 0.7}, {0.2, 0.45, 0.7}, 0.05);
  return scene;
}

TEST(DetectorClosest, IsTheNearestOfAllPairs) {
  for (const double gap : {-0.2, -0.18, 0.0, 0.3}) {
    const CollideScene scene = spaced_scene(gap);
    for (const double cap : {1e-3, 0.1, 2.0}) {
      const auto detector = make_cpu_detector(scene.surfaces, {});

      const ClosestPair found = detector->closest(scene.motion.start, cap);

      const ClosestPair expected = closest_by_force(scene, cap);
      EXPECT_NEAR(found.distance, expected.distance, 1e-14);
      EXPECT_EQ(found.a < 0, expected.a < 0);
      EXPECT_TRUE(found.a >= 0 || found.distance == cap);
    }
  }
}

TEST(DetectorClosest, OfMixedScenesIsTheNearestOfAllPairs) {
  for (unsigned seed = 31; seed < 35; ++seed) {
    const CollideScene scene = mixed_scene(seed, 0);
    const auto detector = make_cpu_detector(scene.surfaces, {});

    const ClosestPair found = detector->closest(scene.motion.start, 0.1);

    EXPECT_NEAR(found.distance, closest_by_force(scene, 0.1).distance, 1e-14);
  }
}

/// The pairs that the motion's detection has found serve where it ends, unless bodies stood still.
TEST(DetectorClosest, AfterAStepKeepsItsPairs) {
  for (unsigned seed = 31; seed < 35; ++seed) {
    const CollideScene scene = mixed_scene(seed, 0.001);
    const auto detector = make_cpu_detector(scene.surfaces, {});
    const ClosestPair expected = detector->closest(scene.motion.end, 0.1);
    detector->counts();
    for (const bool has_still : {false, true}) {
      std::vector<std::uint8_t> is_still(static_cast<std::size_t>(scene.body_count()), 1);
      if (has_still) detector->set_still(is_still);
      detector->begin_step();
      detector->find_touches(scene.motion);

      const ClosestPair found = detector->closest(scene.motion.end, 0.1);

      EXPECT_EQ(found.distance, expected.distance);
      EXPECT_EQ(found.kind, expected.kind);
      EXPECT_EQ(found.a, expected.a);
      EXPECT_EQ(found.b, expected.b);
      EXPECT_EQ(detector->counts().reused, has_still ? 0 : 1);
    }
  }
}

/// A sheet above another: all vertices are equally far from their faces.
TEST(DetectorClosest, IsTheFirstOfEqualPairs) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  scene.add_sheet({0, 0, 0}, 1, 8);
  scene.add_sheet({0, 0, 0.5}, 1, 8);
  for (const int threads : {1, 2, 5}) {
    const auto detector = make_cpu_detector(scene.surfaces, {.threads = threads});

    const ClosestPair found = detector->closest(scene.motion.start, 1);

    EXPECT_EQ(found.kind, PairKind::vertex_face);
    EXPECT_EQ(found.a, 0);
    EXPECT_EQ(found.b, 128);
    EXPECT_EQ(found.distance, 0.5);
  }
}

TEST(DetectorClosest, LeavesLaterDetectionsAsTheyAre) {
  const CollideScene scene = mixed_scene(36, 0.05);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->detect(scene.motion);
  detector->closest(scene.motion.start, 1e-3);

  EXPECT_EQ(detector->detect(scene.motion), detected_by_force(scene));
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_detector_extremes.cpp
/// Scenes with nothing in them, with very different sizes, very far apart.
#include <gtest/gtest.h>

#include <random>

#include "tests/collide/brute_force_pairs.hpp"

namespace tetwarp::test {
namespace {
void expect_pairs_by_force(const CollideScene& scene) {
  const auto detector = make_cpu_detector(scene.surfaces, {.threads = 2});
  EXPECT_EQ(detector->detect(scene.motion), detected_by_force(scene));
  EXPECT_EQ(detector->check(scene.motion), checked_by_force(scene));
}

TEST(DetectorExtremes, EmptyScenesHaveNoPairs) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  const auto nothing = make_cpu_detector(scene.surfaces, {});
  EXPECT_TRUE(nothing->detect(scene.motion).empty());
  EXPECT_TRUE(nothing->check(scene.motion).empty());
  EXPECT_EQ(nothing->closest(scene.motion.start, 1).a, -1);

  scene.add_plane({{0, 0, 0}, {0, 0, 1}});
  expect_pairs_by_force(scene);
  scene.add_ball({0, 0, 1}, 0.5, 3, 5);
  expect_pairs_by_force(scene);
  scene.add_mesh({}, {});
  scene.add_mesh({}, {});
  expect_pairs_by_force(scene);
}

/// Each triangle is about two times as large as the one before; the largest is 1e6 times the
/// smallest.
TEST(DetectorExtremes, SizesMayDifferAMillionTimes) {
  std::mt19937 random(4);
  CollideScene scene;
  scene.surfaces.thickness = 1e-7;
  double size = 1e-3;
  for (int b = 0; b < 21; ++b, size *= 2) {
    scene.add_soup(random, {0, 0, 0}, 0.5 * size, size, 12);
    scene.move_body(b, {0.1 * size, 0, 0});
  }
  ASSERT_GT(size, 1e3);

  expect_pairs_by_force(scene);
}

/// 20 million pairs, which would be 100 million of features.
TEST(DetectorExtremes, ASceneOfTooManyPairsIsRefusedBeforeTheyTakeMemory) {
  std::mt19937 random(5);
  CollideScene scene;
  scene.surfaces.thickness = 1e-3;
  for (int b = 0; b < 2; ++b) scene.add_soup(random, {0, 0, 0}, 0.1, 0.1, 4500);
  scene.move_body(0, {1e3, 1e3, 1e3});
  scene.move_body(1, {1e3, -1e3, 1e3});
  EXPECT_THROW(make_cpu_detector(scene.surfaces, {.threads = 2})->detect(scene.motion),
               TooManyPairs);
}

TEST(DetectorExtremes, OneHugeTriangleAmongTinyOnesNeedsFewTests) {
  CollideScene scene = pile_scene(9, 9000);
  scene.add_mesh({{-1e4, -1e4, -0.03}, {1e4, -1e4, -0.03}, {0, 2e4, -0.03}}, {{0, 1, 2}},
                 {.has_unknowns = false});
  const auto detector = make_cpu_detector(scene.surfaces, {});

  detector->detect(scene.motion);

  const DetectionCounts counts = detector->counts();
  EXPECT_LT(counts.grid_entries, 9 * 9000);
  EXPECT_LT(counts.box_tests, 100 * 9000);
}

/// The cells between the groups are far more than 2^32: cells share numbers.
TEST(DetectorExtremes, GroupsMayBeFarApart) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-4;
  for (int group = 0; group < 4; ++group) {
    const double far = group * 1e6;
    for (int k = 0; k < 3; ++k) {
      scene.add_ball({far + 0.19 * k, -far, far}, 0.1, 4, 6);
      scene.move_body(scene.body_count() - 1, {0, 0, 0.01 * k});
    }
  }

  expect_pairs_by_force(scene);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  EXPECT_GT(detector->detect(scene.motion).size(), 0u);
  EXPECT_LT(detector->counts().box_tests, 20000);
}

/// A fixed ball with as many triangles as all others is skipped where nothing comes near.
TEST(DetectorExtremes, ABodyThatNothingComesNearIsSkipped) {
  CollideScene scene = pile_scene(2, 400);
  scene.add_ball({5, 5, 5}, 0.03, 10, 20);
  const auto detector = make_cpu_detector(scene.surfaces, {});

  detector->detect(scene.motion);

  EXPECT_GT(detector->counts().skipped_items, 400);
}

TEST(DetectorExtremes, WrongSizesAreRefused) {
  CollideScene scene = pile_scene(2, 100);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  scene.motion.end.vertices.pop_back();
  EXPECT_THROW(detector->detect(scene.motion), std::invalid_argument);

  scene.surfaces.edges.clear();
  scene.surfaces.edge_radius.clear();
  EXPECT_THROW(make_cpu_detector(scene.surfaces, {}), std::invalid_argument);
}
}  // namespace
}  // namespace tetwarp::test

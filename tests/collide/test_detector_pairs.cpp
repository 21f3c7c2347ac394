/// @file test_detector_pairs.cpp
/// The detector against tests of all pairs of features.
#include <gtest/gtest.h>

#include <ostream>
#include <random>

#include "tests/collide/brute_force_pairs.hpp"

namespace tetwarp {
// NOLINTNEXTLINE(readability-identifier-naming): GoogleTest calls it
inline void PrintTo(const TouchingPair& pair, std::ostream* out) {
  *out << "kind " << static_cast<int>(pair.kind) << " " << pair.a << " " << pair.b << " at "
       << pair.time << " from " << pair.start_distance;
}
}  // namespace tetwarp

namespace tetwarp::test {
namespace {
/// @returns the number of pairs detected
std::size_t expect_all_pairs(const CollideScene& scene) {
  const auto detector = make_cpu_detector(scene.surfaces, {.threads = 2});
  const std::vector<TouchingPair> found = detector->detect(scene.motion);
  EXPECT_EQ(found, detected_by_force(scene));
  EXPECT_EQ(detector->check(scene.motion), checked_by_force(scene));
  detector->begin_step();
  EXPECT_EQ(detector->check(scene.motion), checked_by_force(scene));
  return found.size();
}

TEST(DetectorPairs, AreThoseOfAllPairsInSlowMotion) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    EXPECT_GT(expect_all_pairs(mixed_scene(seed, 0.01)), 50u);
  }
}

TEST(DetectorPairs, AreThoseOfAllPairsInFastMotion) {
  for (unsigned seed = 11; seed <= 14; ++seed) {
    EXPECT_GT(expect_all_pairs(mixed_scene(seed, 1)), 100u);
  }
}

TEST(DetectorPairs, AreThoseOfAllPairsAtRest) {
  CollideScene scene = mixed_scene(21, 0);
  scene.motion = at_rest(scene.motion.start);

  EXPECT_GT(expect_all_pairs(scene), 0u);
}

TEST(DetectorPairs, AreThoseOfAllPairsFarFromTheOrigin) {
  CollideScene scene = mixed_scene(22, 0.05);
  scene.move_all({1e6, -1e6, 1e6});

  EXPECT_GT(expect_all_pairs(scene), 100u);
}

/// All vertices of a body have the same bound, as the bodies of a scene that turn fast.
TEST(DetectorPairs, KeepTheBoundOfCurvedWays) {
  CollideScene scene = mixed_scene(23, 0.02);
  for (std::size_t v = 0; v < scene.motion.sagitta.size(); ++v) {
    scene.motion.sagitta[v] = 1e-3 * (scene.surfaces.vertex_body[v] % 5);
  }

  EXPECT_GT(expect_all_pairs(scene), 100u);
}

TEST(DetectorPairs, CoverAllKinds) {
  std::array<int, 5> counts{};
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const CollideScene scene = mixed_scene(seed, 1);
    const auto detector = make_cpu_detector(scene.surfaces, {});
    for (const TouchingPair& pair : detector->detect(scene.motion)) {
      ++counts[static_cast<std::size_t>(pair.kind)];
    }
  }

  for (const int count : counts) EXPECT_GT(count, 0);
}

TEST(DetectorPairs, OfSpheresStartAtTheGapOfTheirSurfaces) {
  CollideScene scene;
  scene.surfaces.thickness = 1e-2;
  scene.add_sphere({0, 0, 0}, 0.5);
  scene.add_sphere({2, 0, 0}, 0.25);
  scene.move_body(1, {-2, 0, 0});
  const auto detector = make_cpu_detector(scene.surfaces, {});

  const std::vector<TouchingPair> pairs = detector->detect(scene.motion);

  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].kind, PairKind::vertex_vertex);
  EXPECT_NEAR(pairs[0].start_distance, 1.25, 1e-14);
  EXPECT_GE(pairs[0].time, (1.25 - 0.6e-2) / 2 - 1e-12);
  EXPECT_LE(pairs[0].time, (1.25 - 0.5e-2) / 2);
}
}  // namespace
}  // namespace tetwarp::test

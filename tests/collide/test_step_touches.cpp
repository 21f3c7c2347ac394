/// @file test_step_touches.cpp
/// The touches of the pairs that the detections of a step find.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <tuple>

#include "kernels/base/heap_sort.hpp"
#include "tests/collide/collide_scenes.hpp"

namespace tetwarp::test {
namespace {

using PairKey = std::tuple<PairKind, std::int32_t, std::int32_t>;

template <class Pair>
PairKey key_of(const Pair& pair) {
  return {pair.kind, pair.a, pair.b};
}

std::set<PairKey> keys_of(const std::vector<TouchingPair>& pairs) {
  std::set<PairKey> keys;
  for (const TouchingPair& pair : pairs) keys.insert(key_of(pair));
  return keys;
}

/// A scene and a second motion from the same places.
struct TwoMotions {
  explicit TwoMotions(unsigned seed) : scene(mixed_scene(seed, 0.02)), second(scene) {
    std::mt19937 random(seed);
    for (std::int32_t b = 0; b < scene.body_count(); ++b) second.shake_body(b, 0.03, random);
  }
  CollideScene scene, second;
};

/// A hit whose features are not what is nearest of their surfaces, or which other contacts forbid,
/// is none, so that it may be found again.
TEST(StepTouches, LaterDetectionsAddTheHitsThatAreNew) {
  for (const unsigned seed : {5u, 6u, 7u}) {
    const TwoMotions of(seed);
    const auto detector = make_cpu_detector(of.scene.surfaces, {});
    const std::vector<TouchingPair> all = detector->detect(of.scene.motion);
    std::set<PairKey> hits = keys_of(detector->detect_hits(of.scene.motion));
    hits.merge(keys_of(detector->detect_hits(of.second.motion)));

    detector->begin_step();
    EXPECT_EQ(detector->find_touches(of.scene.motion), std::ssize(all));
    EXPECT_GT(detector->find_touches(of.second.motion), 5);
    EXPECT_EQ(detector->find_touches(of.second.motion), 0);
    detector->find_touches(of.scene.motion);
    EXPECT_EQ(detector->find_touches(of.scene.motion), 0);
    EXPECT_EQ(detector->find_touches(of.second.motion), 0);

    int later = 0;
    std::set<std::tuple<PairKind, std::int32_t, std::int32_t, std::int32_t>> seen;
    for (const ChosenTouch& chosen : detector->touches()) {
      const PairTouch& touch = chosen.touch;
      EXPECT_TRUE(seen.insert({touch.kind, touch.a, touch.b, touch.end}).second);
      EXPECT_TRUE(touch.pass == 0 || hits.count(key_of(touch)) != 0);
      later += touch.pass > 0;
    }
    EXPECT_GT(later, 0);
  }
}

/// Where two bodies are nearest to each other they touch, whatever the rules leave out elsewhere.
TEST(StepTouches, TheNearestPartsOfTwoBodiesAreAlwaysChosen) {
  std::mt19937 random(8);
  std::normal_distribution<double> normal;
  const auto draw = [&] { return Point3{normal(random), normal(random), normal(random)}; };
  const double h = 2e-3;
  for (int k = 0; k < 60; ++k) {
    const Point3 away = unit(draw()), along = times(0.15, draw());
    const auto pair_at = [&](double distance) {
      CollideScene scene;
      scene.surfaces.thickness = h;
      scene.add_ball({0, 0, 0}, 0.1, 4, 7);
      const Point3 place = times(distance, away);
      if (k % 3 == 0) scene.add_ball(place, 0.15, 5, 6);
      if (k % 3 == 1) scene.add_capsule(place, plus(place, along), 0.03);
      if (k % 3 == 2) scene.add_plane({times(0.8, place), times(-1, away)});
      return scene;
    };
    double distance = 1;
    for (int n = 0; n < 30; ++n) {
      const CollideScene scene = pair_at(distance);
      const auto detector = make_cpu_detector(scene.surfaces, {});
      detector->begin_step();
      distance -= 0.8 * (detector->closest(scene.motion.start, 10).distance - 1.5 * h);
    }
    const CollideScene scene = pair_at(distance);
    const auto detector = make_cpu_detector(scene.surfaces, {});
    double nearest = 10, chosen = 10;
    for (const TouchingPair& pair : detector->detect(scene.motion)) {
      nearest = std::min(nearest, pair.start_distance);
    }
    detector->begin_step();
    detector->find_touches(scene.motion);
    for (const auto& [touch, area] : detector->touches()) {
      EXPECT_NEAR(norm(touch.normal), 1, 1e-12);
      chosen = std::min(chosen, touch.distance);
    }
    ASSERT_NEAR(nearest, 1.5 * h, 0.1 * h) << k;
    EXPECT_NEAR(chosen, nearest, 1e-12) << k;
  }
}

/// Surfaces do not cross at the start. A normal along which a point lies beyond the other surface
/// there would hold it on the wrong side, against all other contacts around it.
TEST(StepTouches, NoPairThatIsNearAtTheStartIsTouchedFromBehind) {
  const double h = 2e-3;
  std::int64_t near = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-0.4 * h, 0.4 * h);
    CollideScene scene;
    scene.surfaces.thickness = h;
    scene.add_sheet({0, 0, 0}, 0.05, 6);
    scene.add_sheet({0.011, 0.017, h}, 0.043, 6);
    for (Point3& place : scene.motion.start.vertices) {
      for (double& coordinate : place) coordinate += noise(random);
    }
    scene.motion.end = scene.motion.start;
    scene.move_body(1, {0, 0, -3 * h});
    for (const std::int32_t body : {0, 1}) scene.shake_body(body, 3 * h, random);
    const auto detector = make_cpu_detector(scene.surfaces, {});
    detector->begin_step();
    detector->find_touches(scene.motion);
    for (const auto& [touch, area] : detector->touches()) {
      if (touch.distance >= 2 * h) continue;
      EXPECT_GE(touch.gap, -h) << seed;
      ++near;
    }
  }
  EXPECT_GT(near, 100);
}

TEST(StepTouches, PairsOfBodiesThatStandStillAreLeftOut) {
  const CollideScene scene = mixed_scene(9, 0.02);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  detector->begin_step();
  detector->find_touches(scene.motion);
  std::set<std::array<std::int32_t, 2>> links;
  for (const auto& [touch, area] : detector->touches()) links.insert({touch.body_a, touch.body_b});
  std::vector<std::uint8_t> is_still(static_cast<std::size_t>(scene.body_count()));
  for (std::size_t b = 0; b < is_still.size(); b += 2) is_still[b] = 1;
  const auto stands = [&](std::int32_t body) { return is_still[static_cast<std::size_t>(body)]; };

  detector->set_still(is_still);
  detector->begin_step();
  detector->find_touches(scene.motion);

  std::set<std::array<std::int32_t, 2>> left;
  for (const auto& [touch, area] : detector->touches()) left.insert({touch.body_a, touch.body_b});
  EXPECT_LT(left.size(), links.size());
  EXPECT_GT(left.size(), 0u);
  std::set<std::int32_t> reached;
  for (const auto& [a, b] : links) {
    EXPECT_EQ(left.count({a, b}) == 0, stands(a) && stands(b)) << a << " " << b;
    for (const std::int32_t body : {a, b}) {
      const bool is_free = at(scene.surfaces.bodies, body).has_unknowns;
      if (stands(body) && is_free && !(stands(a) && stands(b))) reached.insert(body);
    }
  }
  EXPECT_GT(reached.size(), 0u);
  EXPECT_EQ(detector->reached(), std::vector<std::int32_t>(reached.begin(), reached.end()));
}

TEST(HeapSort, SortsEverySizeAndOrder) {
  std::mt19937 random(1);
  for (const std::int64_t size : {0, 1, 2, 3, 31, 32, 33, 1025}) {
    std::vector<int> values(static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<int>(i);
    const std::vector<int> expected = values;
    for (int run = 0; run < 20; ++run) {
      if (run == 1) std::ranges::reverse(values);
      if (run > 1) std::ranges::shuffle(values, random);
      heap_sort(values.data(), size, [](int a, int b) { return a < b; });
      ASSERT_EQ(values, expected);
    }
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_step_touches.cpp
/// The touches of the pairs that the detections of a step find.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
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

TEST(StepTouches, LaterDetectionsAddTheHitsThatAreNew) {
  for (const unsigned seed : {5u, 6u, 7u}) {
    const TwoMotions of(seed);
    const auto detector = make_cpu_detector(of.scene.surfaces, {});
    const std::vector<TouchingPair> all = detector->detect(of.scene.motion);
    const std::set<PairKey> first = keys_of(detector->detect_hits(of.scene.motion));
    std::set<PairKey> fresh = keys_of(detector->detect_hits(of.second.motion));
    for (const PairKey& key : first) fresh.erase(key);
    ASSERT_GT(fresh.size(), 5u);

    detector->begin_step();
    EXPECT_EQ(detector->find_touches(of.scene.motion), static_cast<std::int64_t>(all.size()));
    EXPECT_EQ(detector->find_touches(of.second.motion), static_cast<std::int64_t>(fresh.size()));
    EXPECT_EQ(detector->find_touches(of.second.motion), 0);
    EXPECT_EQ(detector->find_touches(of.scene.motion), 0);

    int later = 0;
    std::set<std::tuple<PairKind, std::int32_t, std::int32_t, std::int32_t>> seen;
    for (const ChosenTouch& chosen : detector->touches()) {
      const PairTouch& touch = chosen.touch;
      EXPECT_TRUE(seen.insert({touch.kind, touch.a, touch.b, touch.end}).second);
      EXPECT_EQ(touch.pass, fresh.count(key_of(touch)) != 0 ? 1 : 0);
      later += touch.pass;
    }
    EXPECT_GT(later, 0);
  }
}

/// Each vertex touches what is nearest of a body: of what is near at the start by distance.
TEST(StepTouches, TheNearestPartOfABodyIsAlwaysChosen) {
  const CollideScene scene = mixed_scene(8, 0.02);
  const auto detector = make_cpu_detector(scene.surfaces, {});
  const double near = 2 * scene.surfaces.thickness;
  std::map<std::tuple<std::int32_t, std::int32_t>, double> nearest;
  const auto body_of = [&](const TouchingPair& pair) {
    const CollisionSurfaces& s = scene.surfaces;
    switch (pair.kind) {
      case PairKind::vertex_face:
        return at(s.vertex_body, at(s.triangles, pair.b)[0]);
      case PairKind::vertex_edge:
        return at(s.vertex_body, at(s.edges, pair.b)[0]);
      case PairKind::vertex_vertex:
        return at(s.vertex_body, pair.b);
      default:
        return at(s.plane_body, pair.b);
    }
  };
  for (const TouchingPair& pair : detector->detect(scene.motion)) {
    if (pair.kind == PairKind::edge_edge || pair.start_distance >= near) continue;
    const auto [found, is_new] = nearest.try_emplace({pair.a, body_of(pair)}, pair.start_distance);
    found->second = std::min(found->second, pair.start_distance);
  }
  ASSERT_GT(nearest.size(), 20u);
  detector->begin_step();
  detector->find_touches(scene.motion);

  std::map<std::tuple<std::int32_t, std::int32_t>, double> chosen;
  for (const auto& [touch, area] : detector->touches()) {
    EXPECT_NEAR(norm(touch.normal), 1, 1e-12);
    if (touch.kind != PairKind::edge_edge && touch.time == 0) {
      chosen.try_emplace({touch.a, touch.body_b}, touch.distance);
    }
  }
  for (const auto& [key, distance] : nearest) {
    ASSERT_EQ(chosen.count(key), 1u);
    EXPECT_EQ(chosen[key], distance);
  }
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

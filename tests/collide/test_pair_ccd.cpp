/// @file test_pair_ccd.cpp
/// Constructed meetings of all kinds are found, never late; what the times of touch promise.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/point3.hpp"
#include "tests/collide/constructed_hits.hpp"

namespace tetwarp::test {
namespace {

struct HitsCase {
  HitKind kind;
  bool edges;
};

/// Below this distance a pair must not be before its time of touch.
double least_of(double start_distance, const CcdLimits& limits) {
  if (start_distance > limits.distance) return limits.distance;
  return std::max(start_distance / 2, limits.distance / 100);
}

class ConstructedHits : public testing::TestWithParam<HitsCase> {};

/// 50,000 of each kind, with the limits of detections and of end checks: none is missed or late.
TEST_P(ConstructedHits, AreFoundInTime) {
  const auto [kind, edges] = GetParam();
  std::mt19937_64 random(static_cast<unsigned>(kind) * 2 + edges);
  int missed = 0, late = 0, capped = 0;
  double evaluations = 0;
  const int count = 50000;
  for (int k = 0; k < count; ++k) {
    const MovingPair pair = constructed_hit(kind, edges, random);
    for (const bool detects : {true, false}) {
      const double h = 1e-3 * pair.size;
      const CcdLimits limits = detects ? detection_limits(h) : end_check_limits(h);
      const CcdResult result = ccd_of(pair, edges, limits);
      missed += !(result.time <= 1);
      late += result.time <= 1 && result.time > pair.time;
      capped += result.evaluations >= limits.max_evaluations;
      if (detects) evaluations += result.evaluations;
      if (k % 100 != 0 || !(result.time <= 1)) continue;
      const double least = least_of(result.start_distance, limits);
      for (int s = 0; s <= 8 && result.time > 0; ++s) {
        const double distance = searched_distance(places_at(pair, result.time * s / 8), edges);
        ASSERT_GT(distance, least * (1 - 1e-6)) << k << " at " << s;
      }
    }
  }
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(late, 0);
  RecordProperty("evaluations", std::to_string(evaluations / count));
  RecordProperty("capped", capped);
  EXPECT_LE(evaluations / count, 40);
  EXPECT_LE(capped, count / 10000);
}

std::vector<HitsCase> all_cases() {
  std::vector<HitsCase> cases;
  for (const bool edges : {false, true}) {
    for (const HitKind kind : all_hit_kinds) cases.push_back({kind, edges});
  }
  return cases;
}
INSTANTIATE_TEST_SUITE_P(Kinds,
                         ConstructedHits,
                         testing::ValuesIn(all_cases()),
                         [](const auto& test) {
                           return std::string(test.param.edges ? "edge_edge_" : "vertex_face_") +
                                  name_of(test.param.kind);
                         });

class PairCcd : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Pairs, PairCcd, testing::Bool(), [](const auto& test) {
  return test.param ? "edge_edge" : "vertex_face";
});

/// Of random pairs, most of which do not meet, and of generic meetings down to the slack.
TEST_P(PairCcd, EvaluatesFewDistances) {
  std::mt19937_64 random(5);
  double all = 0, generic = 0;
  const int count = 20000;
  for (int k = 0; k < count; ++k) {
    all += ccd_of(random_pair(random), GetParam(), detection_limits(1e-3)).evaluations;
    const MovingPair hit = constructed_hit(HitKind::generic, GetParam(), random);
    generic += ccd_of(hit, GetParam(), detection_limits(1e-3)).evaluations;
  }
  RecordProperty("random", std::to_string(all / count));
  RecordProperty("generic", std::to_string(generic / count));
  EXPECT_LE(all / count, GetParam() ? 7 : 5);
  EXPECT_LE(generic / count, GetParam() ? 25 : 20);
}

/// What is reported comes within distance + slack: the search finds it near there.
TEST_P(PairCcd, ReportsOnlyPairsThatComeNear) {
  std::mt19937_64 random(6);
  int reported = 0;
  const CcdLimits limits = detection_limits(1e-2);
  for (int k = 0; k < 20000; ++k) {
    const MovingPair pair = random_pair(random);
    const CcdResult result = ccd_of(pair, GetParam(), limits);
    if (result.time > 1) continue;
    ++reported;
    ASSERT_LE(searched_distance(places_at(pair, result.time), GetParam()),
              limits.distance + limits.slack + 1e-14);
  }
  EXPECT_GT(reported, 400);
}

/// At rest, sliding along, or leaving, from any distance: not a touch.
TEST_P(PairCcd, APairThatDoesNotApproachDoesNotTouch) {
  std::mt19937_64 random(7);
  const CcdLimits limits = end_check_limits(1e-3);
  for (const double apart : {2e-6, 1e-5, 0.99e-4, 1e-4, 1.0001e-4, 1.2e-4, 1e-3}) {
    for (const double way : {0.0, 1e-6, 1e-3, 0.1}) {
      MovingPair pair;
      pair.start = {Point3{0, 0, apart}, {-1, -1, 0}, {2, -1, 0}, {0, 2, 0}};
      if (GetParam()) pair.start = {Point3{-1, 0, apart}, {1, 0, apart}, {0, -1, 0}, {0, 1, 0}};
      pair.end = pair.start;
      for (std::size_t k = 0; k < (GetParam() ? 2u : 1u); ++k) pair.end[k][2] += way;
      const CcdResult result = ccd_of(pair, GetParam(), limits);
      EXPECT_GT(result.time, 1) << apart << " " << way;
      EXPECT_NEAR(result.start_distance, apart, 1e-18);
      EXPECT_LE(result.evaluations, 30);
    }
  }
}

/// Steps that end before the time of touch: pushed together for ever, a pair stays apart.
TEST_P(PairCcd, RepeatedPushesNeverBringAPairBelowItsLeastDistance) {
  for (const double start : {1e-3, 1.2e-4, 0.9e-4, 5e-6}) {
    const CcdLimits limits = end_check_limits(1e-3);
    double apart = start;
    for (int step = 0; step < 200; ++step) {
      MovingPair pair;
      pair.start = {Point3{0, 0, apart}, {-1, -1, 0}, {2, -1, 0}, {0, 2, 0}};
      if (GetParam()) pair.start = {Point3{-1, 0, apart}, {1, 0, apart}, {0, -1, 0}, {0, 1, 0}};
      pair.end = pair.start;
      for (std::size_t k = 0; k < (GetParam() ? 2u : 1u); ++k) pair.end[k][2] -= 0.1;
      const CcdResult result = ccd_of(pair, GetParam(), limits);
      ASSERT_LE(result.time, 1);
      apart -= 0.9 * result.time * 0.1;
      ASSERT_GE(apart, limits.distance / 100 * (1 - 1e-9));
      if (start > limits.distance && step < 20) {
        ASSERT_GE(apart, limits.distance * (1 - 1e-12));
      }
    }
  }
}

TEST_P(PairCcd, NotANumberTouchesAtOnce) {
  std::mt19937_64 random(8);
  MovingPair pair = random_pair(random);
  pair.end[1][1] = std::nan("");
  EXPECT_EQ(ccd_of(pair, GetParam(), detection_limits(1e-3)).time, 0);
  pair.start[2][0] = std::nan("");
  EXPECT_EQ(ccd_of(pair, GetParam(), detection_limits(1e-3)).time, 0);
}

}  // namespace
}  // namespace tetwarp::test

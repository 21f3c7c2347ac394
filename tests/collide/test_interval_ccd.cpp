/// @file test_interval_ccd.cpp
/// The interval reference finds the constructed meetings, and the kernels miss none of its own.
#include <gtest/gtest.h>

#include "tests/collide/constructed_hits.hpp"
#include "tests/oracles/interval_ccd.hpp"

namespace tetwarp::test {
namespace {

constexpr std::int64_t most_boxes = 20000;

reference::IntervalHit interval_of(const MovingPair& pair, bool edges) {
  const reference::PairMotion motion{pair.start, pair.end};
  const double tolerance = 1e-6 * pair.size;
  return edges ? interval_edge_edge(motion, tolerance, most_boxes)
               : interval_vertex_face(motion, tolerance, most_boxes);
}

class IntervalCcd : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Pairs, IntervalCcd, testing::Bool(), [](const auto& test) {
  return test.param ? "edge_edge" : "vertex_face";
});

TEST_P(IntervalCcd, FindsAllConstructedMeetings) {
  std::mt19937_64 random(30);
  for (const HitKind kind : all_hit_kinds) {
    if (kind == HitKind::grazing) continue;  // at 1e-12, which is no meeting
    for (int k = 0; k < 50; ++k) {
      const MovingPair pair = constructed_hit(kind, GetParam(), random);
      ASSERT_LE(interval_of(pair, GetParam()).time, pair.time + 1e-12) << name_of(kind) << k;
    }
  }
}

/// The kernels know a thickness: what they do not report stays apart, so the intervals end empty.
TEST_P(IntervalCcd, AdditiveDetectionMissesNoneOfItsMeetings) {
  std::mt19937_64 random(31);
  int met = 0;
  double boxes = 0;
  const int count = 15000;
  for (int k = 0; k < count; ++k) {
    const MovingPair pair = random_pair(random);
    const reference::IntervalHit hit = interval_of(pair, GetParam());
    boxes += static_cast<double>(hit.boxes);
    if (hit.time > 1) continue;
    ASSERT_LT(hit.boxes, most_boxes) << k;  // else nothing is known
    ++met;
    const CcdResult result = ccd_of(pair, GetParam(), detection_limits(1e-3));
    ASSERT_LE(result.time, 1) << k;
    ASSERT_LE(result.time, hit.time + 1e-5) << k;
  }
  RecordProperty("met", met);
  RecordProperty("boxes", std::to_string(boxes / count));
  EXPECT_GT(met, count / 50);
}

TEST_P(IntervalCcd, ProvesThatPairsPassEachOther) {
  reference::PairMotion motion;
  motion.start = {Point3{-1, 0, 0}, {0, 0.1, -1}, {0, 3, 1}, {0, 3, -1}};
  motion.end = motion.start;
  motion.end[0][0] = 1;
  if (GetParam()) {
    motion.start[1] = {-1, -1, 0};
    motion.end[1] = {1, -1, 0};
    motion.start[3] = motion.end[3] = {0, 0.1, 1};
  }
  const auto hit = GetParam() ? interval_edge_edge(motion, 1e-6, most_boxes)
                              : interval_vertex_face(motion, 1e-6, most_boxes);
  EXPECT_GT(hit.time, 1);
  EXPECT_LT(hit.boxes, 500);
}

}  // namespace
}  // namespace tetwarp::test

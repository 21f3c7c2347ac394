/// @file test_ccd_mutants.cpp
/// The constructed meetings tell right from wrong: usual shortcuts fail on them.
#include <gtest/gtest.h>

#include "host/base/point3.hpp"
#include "tests/collide/cubic_ccd.hpp"

namespace tetwarp::test {
namespace {

double missed_by_cubic(HitKind kind, bool edges, double tolerance) {
  std::mt19937_64 random(17);
  const int count = 5000;
  int missed = 0;
  for (int k = 0; k < count; ++k) {
    const MovingPair pair = constructed_hit(kind, edges, random);
    missed += !(cubic_time(pair, edges, tolerance) <= pair.time + 1e-6);
  }
  return missed / double{count};
}

class CcdMutants : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Pairs, CcdMutants, testing::Bool(), [](const auto& test) {
  return test.param ? "edge_edge" : "vertex_face";
});

TEST_P(CcdMutants, ACoplanarityCubicMissesWhatIsInOnePlane) {
  for (const double tolerance : {1e-9, 1e-6}) {
    EXPECT_EQ(missed_by_cubic(HitKind::coplanar_flat, GetParam(), tolerance), 1);
    EXPECT_GE(missed_by_cubic(HitKind::coplanar_tilted, GetParam(), tolerance), 0.7);
    EXPECT_GE(missed_by_cubic(HitKind::degenerate, GetParam(), tolerance), 0.7);
    EXPECT_GE(missed_by_cubic(HitKind::at_end, GetParam(), tolerance), 0.3);
  }
}
TEST_P(CcdMutants, ACoplanarityCubicFindsWhatIsGeneric) {
  for (const HitKind kind : {HitKind::generic, HitKind::translation, HitKind::offset_1e3}) {
    EXPECT_LE(missed_by_cubic(kind, GetParam(), 1e-6), 0.01) << name_of(kind);
  }
}

/// A body that arrives at rest at the thickness has closed nearly all of its gap. A slack relative
/// to that gap takes it for a touch, which would stop the step; the absolute one does not.
TEST_P(CcdMutants, ARelativeSlackStopsBodiesThatArriveAtRest) {
  std::mt19937_64 random(18);
  const double h = 1e-3;
  int stopped = 0, relative = 0;
  const int count = 1000;
  for (int k = 0; k < count; ++k) {
    const double gap = h * std::uniform_real_distribution<double>(20, 2000)(random);
    MovingPair pair;
    pair.start = {Point3{0, 0, h + gap}, {-1, -1, 0}, {2, -1, 0}, {0, 2, 0}};
    if (GetParam()) pair.start = {Point3{-1, 0, h + gap}, {1, 0, h + gap}, {0, -1, 0}, {0, 1, 0}};
    pair.end = pair.start;
    for (std::size_t p = 0; p < (GetParam() ? 2u : 1u); ++p) {
      pair.end[p] = plus(pair.end[p], {0.1, 0.02, -gap});
    }
    CcdLimits limits = end_check_limits(h);
    stopped += ccd_of(pair, GetParam(), limits).time <= 1;
    limits.slack = 0.1 * (h + gap);
    relative += ccd_of(pair, GetParam(), limits).time <= 1;
  }
  EXPECT_EQ(stopped, 0);
  EXPECT_GE(relative, count / 5);
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_pair_distance.cpp
/// Distances of features against a search in extended precision: also of needles, nearly parallel
/// edges, triangles and edges without extent.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "host/base/point3.hpp"
#include "tests/collide/constructed_hits.hpp"

namespace tetwarp::test {
namespace {

using Points = std::array<Point3, 4>;

double largest(const Points& x) {
  double size = 0;
  for (const Point3& p : x) {
    for (const double c : p) size = std::max(size, std::abs(c));
  }
  return size;
}

/// The distance may err by some roundings of the lengths. The second term is what is left of the
/// freedom to choose the closest point of a needle: far below the distance.
double tolerance_of(const Points& x, double distance) {
  const double size = largest(x);
  return 4e-15 * size + std::pow(2e-16 * size, 2.0 / 3) * std::cbrt(distance);
}

void expect_distance(const Points& x, bool edges) {
  double weight[3], s = 0, t = 0;
  const double distance =
      edges ? edge_edge_distance(x[0].data(), x[1].data(), x[2].data(), x[3].data(), &s, &t)
            : vertex_face_distance(x[0].data(), x[1].data(), x[2].data(), x[3].data(), weight);
  const double expected = searched_distance(x, edges);
  ASSERT_NEAR(distance, expected, tolerance_of(x, expected));
  Point3 apart;
  if (edges) {
    ASSERT_TRUE(s >= 0 && s <= 1 && t >= 0 && t <= 1) << s << " " << t;
    apart = minus(plus(x[0], times(s, minus(x[1], x[0]))), plus(x[2], times(t, minus(x[3], x[2]))));
  } else {
    for (const double w : weight) ASSERT_TRUE(w >= 0 && w <= 1) << w;
    ASSERT_NEAR(weight[0] + weight[1] + weight[2], 1, 4e-16);
    apart = x[0];
    for (std::size_t k = 0; k < 3; ++k) apart = minus(apart, times(weight[k], x[1 + k]));
  }
  ASSERT_NEAR(norm(apart), distance, 4e-15 * largest(x));
}

class PairDistance : public testing::TestWithParam<bool> {
 protected:
  Point3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Points points() { return {vector(), vector(), vector(), vector()}; }
  double power(double low, double high) {
    return std::pow(10, std::uniform_real_distribution<double>(low, high)(random_));
  }
  std::mt19937_64 random_{11};

 private:
  std::normal_distribution<double> normal_;
};

TEST_P(PairDistance, OfRandomPoints) {
  for (int k = 0; k < 2000; ++k) expect_distance(points(), GetParam());
}

TEST_P(PairDistance, OfNeedlesAndNearlyParallelEdges) {
  for (int k = 0; k < 4000; ++k) {
    Points x = points();
    const double thin = power(-17, 0), near = power(-12, 0);
    const double s = std::uniform_real_distribution<double>(-0.2, 1.2)(random_);
    if (GetParam()) {
      x[1] = plus(plus(x[0], minus(x[3], x[2])), times(thin, vector()));
      const Point3 shift = minus(plus(x[2], times(s, minus(x[3], x[2]))), x[0]);
      for (std::size_t p = 0; p < 2; ++p) x[p] = plus(plus(x[p], shift), times(near, vector()));
    } else {
      x[3] = plus(plus(x[1], times(s, minus(x[2], x[1]))), times(thin, vector()));
      x[0] = plus(plus(x[1], times(0.4, minus(x[3], x[1]))), times(near, vector()));
    }
    expect_distance(x, GetParam());
  }
}

TEST_P(PairDistance, OfFeaturesWithoutExtent) {
  for (int k = 0; k < 500; ++k) {
    Points x = points();
    for (const std::size_t same : {1, 2, 3}) {
      Points y = x;
      y[same] = y[same == 1 ? 0 : same - 1];
      expect_distance(y, GetParam());
      y[3] = y[2] = y[1];
      expect_distance(y, GetParam());
      y[0] = y[1];
      expect_distance(y, GetParam());
    }
    x[3] = x[2];
    x[1] = x[0];
    expect_distance(x, GetParam());
  }
}

TEST_P(PairDistance, OfTouchingFeaturesIsZeroUpToRounding) {
  std::mt19937_64 random(3);
  for (const HitKind kind : all_hit_kinds) {
    for (int k = 0; k < 200; ++k) {
      const MovingPair pair = constructed_hit(kind, GetParam(), random);
      expect_distance(places_at(pair, pair.time), GetParam());
    }
  }
}

TEST_P(PairDistance, KeepsUnitsFromTinyToHuge) {
  for (const double unit : {1e-60, 1e-20, 1e-6, 1e6, 1e20, 1e60}) {
    for (int k = 0; k < 200; ++k) {
      Points x = points();
      for (Point3& p : x) p = times(unit, p);
      expect_distance(x, GetParam());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pairs, PairDistance, testing::Bool(), [](const auto& test) {
  return test.param ? "edge_edge" : "vertex_face";
});

}  // namespace
}  // namespace tetwarp::test

/// @file test_certify.cpp
/// Proofs about moving triangles: exact decisions against the oracle of intersections, times of
/// meeting against bisection in intervals and in closed form, whole surfaces, wrong input.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <tetwarp/certify.hpp>

#include "host/base/point3.hpp"
#include "host/collide/exact_integer.hpp"
#include "host/collide/moving_triangles.hpp"
#include "tests/oracles/interval_ccd.hpp"
#include "tests/oracles/triangle_intersection.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using SixPlaces = std::array<Point3, 6>;

/// Points of a box; with `steps` > 0 on that many planes per axis, so that many triangles are flat,
/// touch or lie in one plane.
SixPlaces random_places(std::uint64_t seed, int steps) {
  SixPlaces places;
  for (std::size_t n = 0; n < 18; ++n) {
    const double u = scenes::uniform(seed, n);
    places[n / 3][n % 3] = steps > 0 ? std::floor(u * steps) : u;
  }
  return places;
}

bool oracle_intersects(const SixPlaces& x) {
  return reference::triangles_intersect({x[0], x[1], x[2]}, {x[3], x[4], x[5]});
}

MovingSurface moved(const reference::TriangleSet& set, const Point3& start, const Point3& end) {
  MovingSurface surface{{}, {}, set.triangles};
  for (const Point3& x : set.points) {
    surface.start.push_back(plus(x, start));
    surface.end.push_back(plus(x, end));
  }
  return surface;
}

reference::TriangleSet flat_triangle() {
  return {{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{{0, 1, 2}}}};
}

/// A bumpy sphere, open around its two poles.
reference::TriangleSet ball(double radius, int rings) {
  reference::TriangleSet set;
  const int round = 2 * rings;
  for (int ring = 0; ring <= rings; ++ring) {
    for (int step = 0; step < round; ++step) {
      const double polar = M_PI * (ring + 0.5) / (rings + 1), turn = 2 * M_PI * step / round;
      const double r = radius * (1 + 0.1 * std::sin(5 * polar) * std::cos(3 * turn));
      set.points.push_back({r * std::sin(polar) * std::cos(turn),
                            r * std::sin(polar) * std::sin(turn), r * std::cos(polar)});
    }
  }
  for (int ring = 0; ring < rings; ++ring) {
    for (int step = 0; step < round; ++step) {
      const int next = (step + 1) % round;
      const std::int32_t a = ring * round + step, b = ring * round + next, c = a + round,
                         d = b + round;
      set.triangles.push_back({a, c, b});
      set.triangles.push_back({b, c, d});
    }
  }
  return set;
}

TEST(ExactInteger, IsTheMachinesWhereThatSuffices) {
  __extension__ using Wide = __int128;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    const auto draw = [&](std::uint64_t k) {
      const double size = std::ldexp(1.0, static_cast<int>(60 * scenes::uniform(n, k)));
      return static_cast<std::int64_t>((scenes::uniform(n, k + 9) - 0.5) * 2 * size);
    };
    const std::int64_t a = draw(0), b = draw(1), c = draw(2), d = draw(3);
    const Wide value = Wide{a} * b - Wide{c} * d;
    const ExactInteger exact =
        ExactInteger(a) * ExactInteger(b) - ExactInteger(c) * ExactInteger(d);
    ASSERT_EQ(exact.sign(), value > 0 ? 1 : value < 0 ? -1 : 0) << n;
    ASSERT_EQ(ExactInteger(a) < ExactInteger(b), a < b) << n;
    ASSERT_EQ((ExactInteger(a) + ExactInteger(c) - ExactInteger(a + c)).sign(), 0) << n;
  }
}

TEST(ExactInteger, KeepsEveryBitOfNumbersFarApart) {
  const ExactInteger large(0x1.fffffffffffffp+300, 400), small(0x1.8p-390, 400), one(1);
  EXPECT_EQ(((large + small) * (large - small) - (large * large - small * small)).sign(), 0);
  EXPECT_EQ((large + one - large - one).sign(), 0);
  EXPECT_EQ((large * large + one - large * large).sign(), 1);
  EXPECT_EQ(ExactInteger(-1.5, 1).sign(), -1);
  EXPECT_EQ((ExactInteger(-1.5, 1) + ExactInteger(3)).sign(), 0);
  EXPECT_EQ((ExactInteger(INT64_MIN) + ExactInteger(INT64_MAX) + one).sign(), 0);
}

TEST(MovingTriangles, IntersectAsTheOracleSays) {
  int met = 0, count = 0;
  for (const int steps : {2, 3, 4, 0}) {
    for (std::uint64_t seed = 0; seed < 1500; ++seed) {
      const SixPlaces places =
          random_places(seed + 7919 * static_cast<std::uint64_t>(steps), steps);
      const bool expected = oracle_intersects(places);
      ASSERT_EQ(do_intersect({places, places}, 0), expected) << steps << ", seed " << seed;
      met += expected;
      ++count;
    }
  }
  EXPECT_GT(met, count / 5);
  EXPECT_LT(met, count * 9 / 10);
}

TEST(MovingTriangles, IntersectOnTheWayAsTheOracleSays) {
  int met = 0;
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    const SixPlaces start = random_places(seed, 4), end = random_places(seed + 50000, 4);
    SixPlaces middle;  // in quarters, exact
    for (std::size_t p = 0; p < 6; ++p) {
      middle[p] = plus(times(0.75, start[p]), times(0.25, end[p]));
    }
    const bool expected = oracle_intersects(middle);
    ASSERT_EQ(do_intersect({start, end}, end_of_time / 4), expected) << seed;
    met += expected;
  }
  EXPECT_GT(met, 150);
  EXPECT_LT(met, 1350);
}

TEST(MovingTriangles, DecisionsHoldFarFromTheOrigin) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SixPlaces near = random_places(seed, 4), far = near;
    for (Point3& x : far) x = plus(x, {0x1p40, -0x1p45, 0x1p30});
    ASSERT_EQ(do_intersect({far, far}, 0), oracle_intersects(near)) << seed;
  }
}

TEST(MovingTriangles, TimesOfMeetingAreThoseOfBisection) {
  int met = 0, free = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const SixPlaces first = random_places(seed, 0);
    TrianglePairMotion pair{first, random_places(seed + 1000, 0)};
    for (std::size_t p = 3; p < 6; ++p) pair.start[p][2] += 1.1;  // apart at the start
    for (std::size_t p = 0; p < 3; ++p) pair.end[p][0] += seed % 3 == 0 ? 0.9 : 0.2;
    double expected = 2;
    const auto include = [&](std::array<std::size_t, 4> points, bool vertex_face) {
      reference::PairMotion motion;
      for (std::size_t n = 0; n < 4; ++n) {
        motion.start[n] = pair.start[points[n]];
        motion.end[n] = pair.end[points[n]];
      }
      const auto find =
          vertex_face ? reference::interval_vertex_face : reference::interval_edge_edge;
      expected = std::min(expected, find(motion, 1e-7, 1000000).time);
    };
    for (std::size_t a = 0; a < 3; ++a) {
      include({a, 3, 4, 5}, true);
      include({3 + a, 0, 1, 2}, true);
      for (std::size_t b = 0; b < 3; ++b) include({a, (a + 1) % 3, 3 + b, 3 + (b + 1) % 3}, false);
    }
    const PairVerdict found = judge(pair, 1 << 14);
    if (expected > 1) {
      EXPECT_EQ(found.verdict, Verdict::free) << seed;
      ++free;
      continue;
    }
    ASSERT_EQ(found.verdict, Verdict::meets) << seed;
    EXPECT_LE(found.until - found.from, 4) << seed;
    EXPECT_NEAR(std::ldexp(static_cast<double>(found.until), -time_bits), expected, 1e-5) << seed;
    ++met;
  }
  EXPECT_GT(met, 10);
  EXPECT_GT(free, 10);
}

TEST(Certify, PassingThroughIsFound) {
  reference::TriangleSet needle{{{1, 1, 0}, {1, 1, 1}, {1.25, 1, 1}}, {{{0, 1, 2}}}};
  const MovingSurface surfaces[] = {moved(flat_triangle(), {0, 0, 0}, {0, 0, 0}),
                                    moved(needle, {0, 0, 1}, {0, 0, -3})};
  const Certificate found = certify(surfaces);
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.verdict, Verdict::meets);
  EXPECT_LE(found.pairs[0].from, 0.25);
  EXPECT_GE(found.pairs[0].until, 0.25);
  EXPECT_LE(found.pairs[0].until - found.pairs[0].from, 0x1p-39);

  const MovingSurface beside[] = {surfaces[0], moved(needle, {3, 3, 1}, {3, 3, -3})};
  EXPECT_EQ(certify(beside).verdict, Verdict::free);
  EXPECT_EQ(certify(beside).near_pairs, 1);
}

TEST(Certify, TouchingAtTheStartOrTheEndMeets) {
  const MovingSurface ground = moved(flat_triangle(), {0, 0, 0}, {0, 0, 0});
  const MovingSurface lifted[] = {ground, moved(flat_triangle(), {1, 1, 0}, {1, 1, 1})};
  const MovingSurface landed[] = {ground, moved(flat_triangle(), {1, 1, 1}, {1, 1, 0})};
  const MovingSurface hovering[] = {ground, moved(flat_triangle(), {1, 1, 1}, {1, 1, 0x1p-30})};
  ASSERT_EQ(certify(lifted).verdict, Verdict::meets);
  EXPECT_EQ(certify(lifted).pairs[0].until, 0);
  ASSERT_EQ(certify(landed).verdict, Verdict::meets);
  EXPECT_EQ(certify(landed).pairs[0].until, 1);
  EXPECT_GE(certify(landed).pairs[0].from, 1 - 0x1p-39);
  EXPECT_EQ(certify(hovering).verdict, Verdict::free);
}

TEST(Certify, TouchingForAMomentIsUndecidedUnlessAtAMultiple) {
  // A point passes the border of the triangle, on it only at time 1 / rise.
  const MovingSurface ground = moved(flat_triangle(), {0, 0, 0}, {0, 0, 0});
  for (const int rise : {2, 3}) {
    const MovingSurface point{{{1, -1, -1}}, {{1, rise - 1.0, rise - 1.0}}, {{0, 0, 0}}};
    const MovingSurface surfaces[] = {ground, point};
    const Certificate found = certify(surfaces);
    ASSERT_EQ(found.pairs.size(), 1u);
    EXPECT_EQ(found.verdict, rise == 2 ? Verdict::meets : Verdict::undecided);
    EXPECT_LE(found.pairs[0].from, 1.0 / rise);
    EXPECT_GE(found.pairs[0].until, 1.0 / rise);
    EXPECT_LE(found.pairs[0].until - found.pairs[0].from, 0x1p-37);
  }
}

TEST(Certify, ADistanceBelowRoundingIsFree) {
  const MovingSurface ground = moved(flat_triangle(), {0, 0, 1}, {5, 2, 1});
  const MovingSurface above[] = {ground,
                                 moved(flat_triangle(), {1, 1, 1 + 0x1p-52}, {6, 3, 1 + 0x1p-52})};
  const Certificate found = certify(above);
  EXPECT_EQ(found.verdict, Verdict::free);
  EXPECT_LE(found.intervals, 3);
}

TEST(Certify, WholeSurfacesAreThePairsOfTheOracle) {
  const reference::TriangleSet a = ball(1, 12), b = ball(0.8, 10);
  const MovingSurface apart[] = {moved(a, {0, 0, 0}, {0.3, 0, 0}),
                                 moved(b, {2.1, 0.1, 0}, {2.3, 0, 0})};
  const Certificate free = certify(apart);
  EXPECT_EQ(free.verdict, Verdict::free);
  EXPECT_GT(free.near_pairs, 0);

  reference::TriangleSet shifted = b;
  for (Point3& x : shifted.points) x = plus(x, {1.5, 0.1, 0});
  const MovingSurface still[] = {moved(a, {0, 0, 0}, {0, 0, 0}),
                                 moved(shifted, {0, 0, 0}, {0, 0, 0})};
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (const CertifiedPair& pair : certify(still).pairs) {
    EXPECT_EQ(pair.verdict, Verdict::meets);
    EXPECT_EQ(pair.until, 0);
    pairs.push_back(pair.triangles);
  }
  EXPECT_GT(pairs.size(), 10u);
  EXPECT_EQ(pairs, reference::intersecting_triangles(a, shifted));
}

TEST(Certify, ResultsDoNotDependOnThreads) {
  const MovingSurface surfaces[] = {moved(ball(1, 10), {0, 0, 0}, {1, 0, 0}),
                                    moved(ball(0.8, 8), {2.3, 0.1, 0}, {2, 0, 0})};
  const Certificate one = certify(surfaces, {.threads = 1}),
                    three = certify(surfaces, {.threads = 3});
  EXPECT_EQ(one.verdict, Verdict::meets);
  EXPECT_EQ(one.pairs, three.pairs);
  EXPECT_EQ(one.intervals, three.intervals);
}

TEST(Certify, ASurfaceMeetsItself) {
  // Two triangles of one surface, the second of which falls through the first.
  reference::TriangleSet set = flat_triangle();
  set.points.insert(set.points.end(), {{1, 1, 1}, {1, 1, 2}, {1.5, 1, 2}});
  set.triangles.push_back({3, 4, 5});
  set.triangles.push_back({0, 1, 4});  // shares points with both
  MovingSurface surface = moved(set, {0, 0, 0}, {0, 0, 0});
  surface.end[3][2] = -1;
  const Certificate found = certify(std::span(&surface, 1));
  ASSERT_EQ(found.pairs.size(), 1u);
  EXPECT_EQ(found.pairs[0].triangles, (std::array<std::int32_t, 2>{0, 1}));
  EXPECT_EQ(certify(std::span(&surface, 1), {.self = false}).verdict, Verdict::free);
  EXPECT_EQ(certify({}).verdict, Verdict::free);
}

TEST(Certify, BadArgumentsAreNamed) {
  const auto message = [](MovingSurface surface, const CertifyOptions& options = {}) {
    return message_of([&] { certify(std::span(&surface, 1), options); });
  };
  const MovingSurface good = moved(flat_triangle(), {0, 0, 0}, {0, 0, 0});
  MovingSurface bad = good;
  bad.end.pop_back();
  EXPECT_NE(message(bad).find("surface 0: expected as many points"), std::string::npos);
  bad = good;
  bad.end[1][2] = NAN;
  EXPECT_NE(message(bad).find("surface 0 at the end: point 1 has"), std::string::npos);
  bad = good;
  bad.triangles[0][1] = 3;
  EXPECT_NE(message(bad).find("triangle 0 has a point beyond the 3"), std::string::npos);
  EXPECT_NE(message(good, {.most_intervals = 0}).find("most_intervals"), std::string::npos);
  EXPECT_EQ(message(good), "");
}

}  // namespace
}  // namespace tetwarp::test

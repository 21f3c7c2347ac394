/// @file test_triangle_intersection.cpp
/// The exact test of intersecting triangles: signs, touching by less than any tolerance, degenerate
/// triangles, and all pairs of sets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "host/base/point3.hpp"
#include "tests/oracles/exact_sign.hpp"
#include "tests/oracles/triangle_intersection.hpp"

namespace tetwarp::test {
namespace {

using reference::orientation;
using reference::Triangle;
using reference::triangles_intersect;

const Triangle floor_triangle = {Point3{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

/// All orders of the corners and both orders of the triangles agree.
void expect_intersect(Triangle a, Triangle b, bool expected) {
  for (int i = 0; i < 6; ++i) {
    for (int k = 0; k < 6; ++k) {
      ASSERT_EQ(triangles_intersect(a, b), expected) << i << k;
      ASSERT_EQ(triangles_intersect(b, a), expected) << i << k;
      std::rotate(b.begin(), b.begin() + 1, b.end());
      if (k == 2) std::swap(b[0], b[1]);
    }
    std::rotate(a.begin(), a.begin() + 1, a.end());
    if (i == 2) std::swap(a[0], a[1]);
  }
}

TEST(ExactSign, SeesTheLastBitOfFarPoints) {
  const double up = std::nextafter(1e6, 2e6), down = std::nextafter(1e6, 0);
  const Point3 a{1e6, 1e6, 1e6}, b{1e6 + 1, 1e6, 1e6}, c{1e6, 1e6 + 1, 1e6};
  EXPECT_EQ(orientation(a, b, c, Point3{1e6 + 0.3, 1e6 + 0.3, 1e6}), 0);
  EXPECT_EQ(orientation(a, b, c, Point3{1e6 + 0.3, 1e6 + 0.3, up}), -1);
  EXPECT_EQ(orientation(a, b, c, Point3{1e6 + 0.3, 1e6 + 0.3, down}), 1);
}

/// Points on a line or plane of small integers times a power of two stay there exactly.
TEST(ExactSign, IsZeroExactlyWherePointsAreInOnePlane) {
  std::mt19937_64 random(1);
  std::uniform_int_distribution<int> small(-50, 50);
  const auto vector = [&] {
    return Point3{0.1 * small(random), 0.1 * small(random), 0.1 * small(random)};
  };
  for (int k = 0; k < 2000; ++k) {
    Point3 a = vector(), b = vector(), c = vector();
    for (Point3* p : {&a, &b, &c}) {
      for (double& x : *p) x = std::ldexp(std::round(std::ldexp(x, 20)), -20);
    }
    const Point3 d = plus(a, plus(times(3, minus(b, a)), times(-7, minus(c, a))));
    ASSERT_EQ(orientation(a, b, c, d), 0);
    const std::array<double, 2> p{a[0], a[1]}, q{b[0], b[1]};
    ASSERT_EQ(orientation(p, q, {5 * q[0] - 4 * p[0], 5 * q[1] - 4 * p[1]}), 0);
  }
}

TEST(TriangleIntersection, OfPiercingTouchingAndApart) {
  for (const double z : {-1.0, -1e-80, 0.0, 1e-80, 1.0}) {
    const Triangle standing = {Point3{1, 1, z}, {1, 1.5, z + 2}, {1.5, 1, z + 2}};
    expect_intersect(floor_triangle, standing, z <= 0);
    const Triangle at_corner = {Point3{0, 0, z}, {-1, 0, z + 2}, {0, -1, z + 2}};
    expect_intersect(floor_triangle, at_corner, z == 0);
  }
  const double beyond = std::nextafter(4, 5);
  expect_intersect(floor_triangle, {Point3{4, 0, -1}, {4, 0, 1}, {9, 0, 1}}, true);
  expect_intersect(floor_triangle, {Point3{beyond, 0, -1}, {beyond, 0, 1}, {9, 0, 1}}, false);
}

TEST(TriangleIntersection, OfTrianglesInOnePlane) {
  expect_intersect(floor_triangle, {Point3{1, 1, 0}, {1.5, 1, 0}, {1, 1.5, 0}}, true);
  expect_intersect(floor_triangle, {Point3{2, 2, 0}, {5, 2, 0}, {5, 5, 0}}, true);
  expect_intersect(floor_triangle, {Point3{2, std::nextafter(2, 3), 0}, {5, 3, 0}, {5, 5, 0}},
                   false);
  expect_intersect(floor_triangle, {Point3{-1, -1, 0}, {9, -1, 0}, {-1, 9, 0}}, true);
  expect_intersect(floor_triangle, {Point3{-1, -1, 0}, {9, -1, 0}, {4, -1e-80, 0}}, false);
}

TEST(TriangleIntersection, OfTrianglesWithoutArea) {
  const Point3 inside{1, 1, 0}, above{1, 1, 1e-9}, far{7, 7, 0};
  expect_intersect(floor_triangle, {inside, inside, inside}, true);
  expect_intersect(floor_triangle, {above, above, above}, false);
  expect_intersect(floor_triangle, {inside, far, far}, true);
  expect_intersect(floor_triangle, {above, far, {13, 13, -1e-9}}, false);
  expect_intersect({inside, inside, inside}, {inside, inside, inside}, true);
  expect_intersect({Point3{0, 0, 0}, {2, 2, 2}, {1, 1, 1}}, {Point3{0, 2, 1}, {2, 0, 1}, {1, 1, 1}},
                   true);
  expect_intersect({Point3{0, 0, 0}, {2, 2, 2}, {1, 1, 1}}, {Point3{3, 3, 3}, {5, 5, 5}, {4, 4, 4}},
                   false);
  expect_intersect({Point3{0, 0, 0}, {3, 3, 3}, {1, 1, 1}}, {Point3{3, 3, 3}, {5, 5, 5}, {4, 4, 4}},
                   true);
}

/// Triangles that share a point made of their corners, and the same moved apart along the normal of
/// a plane between them.
TEST(TriangleIntersection, OfRandomTrianglesIsKnown) {
  std::mt19937_64 random(2);
  std::uniform_int_distribution<int> grid(-8, 8);
  std::normal_distribution<double> normal;
  for (int k = 0; k < 3000; ++k) {
    const auto on_grid = [&] {
      return Point3{double(grid(random)), double(grid(random)), double(grid(random))};
    };
    const Triangle a = {on_grid(), on_grid(), on_grid()};
    Triangle b = {on_grid(), on_grid(), on_grid()};
    const auto middle = [](const Triangle& t) {
      return plus(times(0.25, t[0]), plus(times(0.25, t[1]), times(0.5, t[2])));
    };
    const Point3 way = minus(middle(a), middle(b));
    for (Point3& p : b) p = plus(p, way);
    ASSERT_TRUE(triangles_intersect(a, b)) << k;
    const Point3 n{normal(random), normal(random), normal(random)};
    double most = 0, least = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      most = std::max(most, dot(n, minus(a[c], a[0])));
      least = std::min(least, dot(n, minus(b[c], a[0])));
    }
    for (Point3& p : b) p = plus(p, times((most - least) / dot(n, n) * (1 + 1e-12) + 1e-12, n));
    ASSERT_FALSE(triangles_intersect(a, b)) << k;
  }
}

reference::TriangleSet box_at(const Point3& low) {
  reference::TriangleSet set;
  for (int c = 0; c < 8; ++c) {
    set.points.push_back(plus(low, {double(c & 1), double(c >> 1 & 1), double(c >> 2)}));
  }
  set.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return set;
}

TEST(TriangleSets, AllPairsAreTested) {
  const auto one = box_at({0, 0, 0}), near = box_at({1 + 1e-12, 0, 0}),
             in = box_at({0.9, 0.5, 0.5});
  EXPECT_TRUE(reference::intersecting_triangles(one, near).empty());
  const auto found = reference::intersecting_triangles(one, in);
  std::vector<std::array<std::int32_t, 2>> expected;
  for (std::int32_t i = 0; i < 12; ++i) {
    for (std::int32_t k = 0; k < 12; ++k) {
      const auto of = [](const reference::TriangleSet& set, std::int32_t t) {
        const auto& v = set.triangles[static_cast<std::size_t>(t)];
        return Triangle{at(set.points, v[0]), at(set.points, v[1]), at(set.points, v[2])};
      };
      if (triangles_intersect(of(one, i), of(in, k))) expected.push_back({i, k});
    }
  }
  EXPECT_FALSE(found.empty());
  EXPECT_EQ(found, expected);
  EXPECT_TRUE(reference::self_intersections(one).empty());
  EXPECT_EQ(reference::intersecting_sets({one, box_at({9, 9, 9}), in, near}),
            (std::vector<std::array<std::int32_t, 2>>{{0, 2}, {2, 3}}));
  auto both = one;
  for (const Point3& p : in.points) both.points.push_back(p);
  for (auto t : in.triangles) both.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
  EXPECT_EQ(reference::self_intersections(both).size(), found.size());
}

TEST(TriangleSets, BadSetsAreRefused) {
  auto bad = box_at({0, 0, 0});
  bad.triangles[3][1] = 8;
  EXPECT_THROW(reference::self_intersections(bad), std::invalid_argument);
  bad = box_at({std::nan(""), 0, 0});
  EXPECT_THROW(reference::intersecting_triangles(bad, bad), std::invalid_argument);
}

}  // namespace
}  // namespace tetwarp::test

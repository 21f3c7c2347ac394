/// @file test_facet_parts.cpp
/// Facets cut at the planes of voxels: areas, moments and places of their parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "host/warp/cpu/facet_parts.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Triangle = Polygon<3>;

FacetParts parts_of(const Triangle& facet, const int (&origin)[3] = {0, 0, 0}) {
  FacetParts parts;
  parts.add(facet, {{facet, 0}, {facet, 1}, {facet, 2}}, origin);
  return parts;
}

/// Its projected area, and the integral of x over it.
std::pair<double, double> moments_of(const Triangle& facet) {
  const double *a = facet.corner[0].x, *b = facet.corner[1].x, *c = facet.corner[2].x;
  const double area = 0.5 * ((b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]));
  return {area, area * (a[0] + b[0] + c[0]) / 3};
}

/// Corners at random, or at multiples of a half.
TEST(FacetParts, AddUpToTheFacetAndAreWithinTheirVoxels) {
  std::uint64_t counter = 0;
  for (int round = 0; round < 3000; ++round) {
    const double size = 1 + round % 7;
    Triangle facet;
    for (int c = 0; c < 3; ++c) {
      Triangle::Corner corner;
      for (double& x : corner.x) {
        x = size * (2 * scenes::uniform(7, counter++) - 1);
        if (round % 3 == 0) x = std::round(2 * x) / 2;
      }
      facet.append(corner);
    }
    const auto [area, integral] = moments_of(facet);
    const FacetParts parts = parts_of(facet, {5, -3, 100});
    double area_sum = 0, integral_sum = 0;
    for (std::int64_t p = 0; p < parts.size(); ++p) {
      const FacetPart& part = parts.data()[p];
      area_sum += part.area;
      integral_sum += part.moment + part.area * (part.voxel[0] - 5);
      const double share = part.moment * (area > 0 ? 1 : -1);
      EXPECT_GE(share, -1e-13);
      EXPECT_LE(share, std::abs(part.area) + 1e-13);
      EXPECT_LE(std::abs(part.area), 1 + 1e-13);
    }
    ASSERT_NEAR(area_sum, area, 1e-13 * size * size);
    ASSERT_NEAR(integral_sum, integral, 1e-13 * size * size * size);
  }
}

/// The square from (0, 0) to (2, 2) in the plane x = 0.25 + y / 2.
TEST(FacetParts, AreThoseOfEachVoxel) {
  Triangle square;
  for (const auto& [y, z] : {std::pair{0, 0}, {2, 0}, {2, 2}, {0, 2}}) {
    square.append({{0.25 + 0.5 * y, 1.0 * y, 1.0 * z}});
  }
  std::map<std::tuple<int, int, int>, std::pair<double, double>> found;
  const FacetParts parts = parts_of(square);
  for (std::int64_t p = 0; p < parts.size(); ++p) {
    const FacetPart& part = parts.data()[p];
    found[{part.voxel[0], part.voxel[1], part.voxel[2]}] = {part.area, part.moment};
  }
  ASSERT_EQ(found.size(), 6u);
  for (const int k : {0, 1}) {
    const auto near = [&](int i, int j, double area, double mean) {
      const auto& [a, m] = found[{i, j, k}];
      EXPECT_NEAR(a, area, 1e-15);
      EXPECT_NEAR(m, area * mean, 1e-15);
    };
    near(0, 0, 1, 0.5);
    near(0, 1, 0.5, 0.875);
    near(1, 1, 0.5, 0.125);
  }
}

/// Area in the plane of the first two coordinates.
double area_across_z(const Triangle& polygon) {
  double area = 0;
  for (int c = 0; c < polygon.count; ++c) {
    const double *a = polygon.corner[c].x, *b = polygon.corner[(c + 1) % polygon.count].x;
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  return area;
}

/// An edge in the plane, whose corners rounding has put on its two sides in turn.
TEST(CutPolygon, KeepsItsAreaWhereCornersAreInThePlane) {
  constexpr double tiny = 1e-16;
  for (int pattern = 0; pattern < 16; ++pattern) {
    Triangle square, below, above;
    square.append({{-2, 0, 0}});
    for (int c = 0; c < 4; ++c) {
      square.append({{(pattern >> c & 1) != 0 ? tiny : -tiny, c < 2 ? 0.0 : 1.0 * (c - 1), 0}});
    }
    square.append({{-2, 2, 0}});
    cut_polygon<0>(square, 0.0, &below, above);
    EXPECT_NEAR(std::abs(area_across_z(below)), 4, 1e-14) << pattern;
    EXPECT_NEAR(area_across_z(above), 0, 1e-14) << pattern;
    cut_polygon<0, 3>(square, 0.0, nullptr, above);
    EXPECT_NEAR(area_across_z(above), 0, 1e-14) << pattern;
  }
}

/// Area projected along x.
double area_across_x(const Triangle& polygon) {
  double area = 0;
  for (int c = 0; c < polygon.count; ++c) {
    const double *a = polygon.corner[c].x, *b = polygon.corner[(c + 1) % polygon.count].x;
    area += 0.5 * (a[1] * b[2] - a[2] * b[1]);
  }
  return area;
}

/// A convex polygon of corners on a circle about (0, y, z), in the plane of its center or on either
/// side of it by rounding.
Triangle rounded_polygon(int corners, std::uint64_t seed, double y, double z) {
  Triangle polygon;
  for (int c = 0; c < corners; ++c) {
    const auto at = static_cast<std::uint64_t>(c);
    const double angle = 2 * M_PI * (c + 0.8 * scenes::uniform(seed, at)) / corners;
    const double x = std::floor(3 * scenes::uniform(seed, 100 + at)) - 1;
    polygon.append({{1e-16 * x, y + 1.3 * std::cos(angle), z + 1.3 * std::sin(angle)}});
  }
  return polygon;
}

/// However rounding places the corners beside the plane: as many as two crossings would leave, all
/// of them on the right side to within rounding, and no part of the area is lost.
TEST(CutPolygon, CrossesAPlaneTwiceAtMost) {
  int most_signs = 0;
  for (std::uint64_t round = 0; round < 4000; ++round) {
    const int corners = 3 + static_cast<int>(round % (Triangle::max_count - 3));
    const Triangle polygon = rounded_polygon(corners, round, 0.2, 0.3);
    int signs = 0;
    for (int c = 0; c < corners; ++c) {
      const double *a = polygon.corner[c].x, *b = polygon.corner[(c + 1) % corners].x;
      signs += (a[0] >= 0) != (b[0] >= 0);
    }
    most_signs = std::max(most_signs, signs);
    Triangle below, above, alone;
    cut_polygon<0>(polygon, 0.0, &below, above);
    cut_polygon<0, 3>(polygon, 0.0, nullptr, alone);
    ASSERT_LE(below.count, corners + 1);
    ASSERT_LE(above.count, corners + 1);
    ASSERT_EQ(alone.count, above.count);
    for (int c = 0; c < below.count; ++c) ASSERT_LE(below.corner[c].x[0], 1e-16);
    for (int c = 0; c < above.count; ++c) ASSERT_GE(above.corner[c].x[0], -1e-16);
    ASSERT_NEAR(area_across_x(below) + area_across_x(above), area_across_x(polygon), 1e-14);
  }
  EXPECT_GE(most_signs, 8);
}

/// The largest facets that a cell gives, in a plane between voxels to within rounding: all of their
/// area is in the voxels on the two sides.
TEST(FacetParts, KeepTheAreaOfFacetsInAPlane) {
  for (std::uint64_t round = 0; round < 500; ++round) {
    const Triangle facet = rounded_polygon(9, round, round % 2 == 0 ? 0.5 : 0.3, 0.5);
    const FacetParts parts = parts_of(facet);
    double area = 0;
    for (std::int64_t p = 0; p < parts.size(); ++p) area += parts.data()[p].area;
    ASSERT_NEAR(area, area_across_x(facet), 1e-14);
  }
}

TEST(CutPolygon, HasItsPartsOnBothSides) {
  Triangle facet, below, above;
  facet.append({{0, 0, 0}});
  facet.append({{2, 0, 0}});
  facet.append({{2, 2, 0}});
  cut_polygon<0>(facet, 2.0, &below, above);  // an edge in the plane
  EXPECT_EQ(below.count, 3);
  EXPECT_EQ(above.count, 4);
  EXPECT_NEAR(area_across_z(above), 0, 1e-15);
  cut_polygon<0>(facet, 3.0, &below, above);
  EXPECT_EQ(below.count, 3);
  EXPECT_FALSE(above.has_area());
  cut_polygon<0>(facet, 1.0, &below, above);
  EXPECT_EQ(below.count, 3);
  EXPECT_EQ(above.count, 4);
}
}  // namespace
}  // namespace tetwarp::test

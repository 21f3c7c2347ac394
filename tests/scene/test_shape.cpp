/// @file test_shape.cpp
/// Shapes: inside tests, bounds and volumes against sampling; lattices of shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host/scene/shapes/shape.hpp"
#include "host/scene/shapes/shape_fraction.hpp"
#include "tests/scene/shape_samples.hpp"

namespace tetwarp {
namespace {
using scene_checks::named_shapes;

/// Points of the bounds in the middle of n x n x n equal boxes.
template <class Visit>
void for_samples(const Bounds& bounds, int n, const Visit& visit) {
  const Point3 length = minus(bounds.high, bounds.low);
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        visit(Point3{bounds.low[0] + length[0] * (i + 0.5) / n,
                     bounds.low[1] + length[1] * (j + 0.5) / n,
                     bounds.low[2] + length[2] * (k + 0.5) / n});
      }
    }
  }
}

TEST(Shape, HasTheVolumeOfThePointsInside) {
  constexpr int n = 80;
  for (const auto& named : named_shapes()) {
    const std::string& name = named.first;
    const Shape& shape = named.second;
    const Bounds bounds = bounds_of(shape);
    const Point3 length = minus(bounds.high, bounds.low);
    const auto level = make_level(shape);
    double inside = 0;

    for_samples(bounds, n, [&](const Point3& x) { inside += level(x) <= 0; });

    const double volume = inside * length[0] * length[1] * length[2] / (double{n} * n * n);
    EXPECT_NEAR(volume / volume_of(shape), 1, 0.01) << name;
  }
}

TEST(Shape, IsOutsideBeyondItsBounds) {
  for (const auto& named : named_shapes()) {
    const std::string& name = named.first;
    const Shape& shape = named.second;
    const Bounds bounds = bounds_of(shape);
    const auto level = make_level(shape);
    Bounds wide = bounds;
    for (std::size_t d = 0; d < 3; ++d) {
      wide.low[d] -= 0.5 * (bounds.high[d] - bounds.low[d]);
      wide.high[d] += 0.5 * (bounds.high[d] - bounds.low[d]);
    }
    for_samples(wide, 41, [&](const Point3& x) {
      bool is_within = true;
      for (std::size_t d = 0; d < 3; ++d) {
        is_within = is_within && x[d] >= bounds.low[d] && x[d] <= bounds.high[d];
      }
      if (!is_within) {
        ASSERT_GT(level(x), 0) << name;
      }
    });
  }
}

/// Differences over small and large distances; the fraction of tetrahedra relies on the slope.
TEST(Shape, HasALevelOfBoundedSlope) {
  for (const auto& named : named_shapes()) {
    const std::string& name = named.first;
    const Shape& shape = named.second;
    const Bounds bounds = bounds_of(shape);
    const double slope = level_slope(shape) * (1 + 1e-12);
    const auto level = make_level(shape);
    Point3 last = bounds.low;
    for_samples(bounds, 31, [&](const Point3& x) {
      const double difference = std::abs(level(x) - level(last));
      ASSERT_LE(difference, slope * norm(minus(x, last))) << name;
      last = x;
    });
  }
}

TEST(Shape, CutsATetrahedronExactlyAtAPlane) {
  const BoxShape half_space{{10, 10, 10}};  // x <= 10 near the tetrahedron
  const auto fraction = [&](double x) {
    const TetMesh tet{{{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}, {x, 0, 1}}, {{0, 1, 2, 3}}};
    return fractions_inside(half_space, tet, 0.25)[0];
  };

  EXPECT_EQ(fraction(10), 0);
  EXPECT_EQ(fraction(9), 1);
  for (const double inside : {0.1, 0.25, 0.5, 0.8}) {
    EXPECT_NEAR(fraction(10 - inside), 1 - std::pow(1 - inside, 3), 1e-12);
  }
}

TEST(Shape, CutsATetrahedronInTwoAndTwo) {
  const BoxShape half_space{{10, 10, 10}};
  // Edge a-b is at x = 10 - s, edge c-d at x = 11 - s: the part inside is 3 s^2 - 2 s^3.
  for (const double s : {0.1, 0.5, 0.7}) {
    const double a = 10 - s;

    const TetMesh tet{{{a, 0, 0}, {a, 1, 0}, {a + 1, 0, 0}, {a + 1, 0, 1}}, {{0, 1, 2, 3}}};

    const double fraction = fractions_inside(half_space, tet, 2)[0];

    EXPECT_NEAR(fraction, 3 * s * s - 2 * s * s * s, 1e-12);
  }
}

}  // namespace
}  // namespace tetwarp

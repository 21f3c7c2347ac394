/// @file test_lorentz_cone.cpp
/// The algebra of Lorentz cones: inverse products, steps to the boundary, scalings that map two
/// points to the same one.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "host/contact/newton/lorentz_cone.hpp"

namespace tetwarp::test {
namespace {
using lorentz::Vector;

/// Two points inside each of the cones of one, two and three dimensions.
const std::pair<Vector, Vector> inner_points[] = {
    {{2, 0, 0}, {0.5, 0, 0}}, {{2, -1.5, 0}, {1, 0.25, 0}}, {{3, 1, -2}, {1e-3, -2e-4, 9e-4}}};

TEST(LorentzCone, QuotientUndoesTheProduct) {
  for (const auto& [x, y] : inner_points) {
    const Vector back = lorentz::quotient(lorentz::product(x, y), x);

    EXPECT_LE((back - y).norm(), 1e-14 * y.norm());
  }
}

TEST(LorentzCone, DeterminantIsZeroOnTheBoundaryOnly) {
  EXPECT_EQ(lorentz::determinant({5, 3, -4}), 0);
  EXPECT_EQ(lorentz::determinant({2, 1, 0}), 3);
  EXPECT_LT(lorentz::determinant({1, 2, 0}), 0);
}

/// (3, 1, -2) leaves at the first root of (3 - t)^2 = (1 + t)^2 + 4, which is 1/2.
TEST(LorentzCone, EndsAStepWhereItLeavesTheCone) {
  EXPECT_DOUBLE_EQ(lorentz::distance_to_boundary({3, 1, -2}, {-1, 1, 0}), 0.5);
  EXPECT_DOUBLE_EQ(lorentz::distance_to_boundary({2, 0, 0}, {-4, 0, 0}), 0.5);
  EXPECT_DOUBLE_EQ(lorentz::distance_to_boundary({2, 0, 0}, {1, 3, 0}), 1);
}

TEST(LorentzCone, NeverLeavesAlongItsOwnDirections) {
  EXPECT_TRUE(std::isinf(lorentz::distance_to_boundary({3, 1, -2}, {2, 1, 1})));
  EXPECT_TRUE(std::isinf(lorentz::distance_to_boundary({1, 0, 0}, {0, 0, 0})));
}

/// V y = V^-1 x, and V V^-1 = 1.
TEST(LorentzCone, ScalingMakesTwoPointsOne) {
  for (const auto& [x, y] : inner_points) {
    const lorentz::Scaling scaling = lorentz::scaling_of(x, y);

    const Vector middle = scaling.forward * y;
    EXPECT_LE((middle - scaling.inverse * x).norm(), 1e-13 * middle.norm());
    EXPECT_GT(lorentz::determinant(middle), 0);
    const lorentz::Matrix product = scaling.forward * scaling.inverse;
    EXPECT_TRUE(product.isIdentity(1e-13)) << product;
  }
}
}  // namespace
}  // namespace tetwarp::test

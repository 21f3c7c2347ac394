/// @file test_curve_map.cpp
/// The quadratic map of ten nodes and its inverse, for one place at a time.
#include "kernels/warp/curve_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {

/// A tetrahedron of unequal edges whose middle nodes are up to `bend` off along each axis.
CurveNodes bent_nodes(double bend, std::uint64_t seed) {
  CurveNodes nodes{{{1, 2, 3}, {9, 3, 2}, {2, 8, 4}, {3, 4, 10}}};
  for (int e = 0; e < 6; ++e) {
    for (int axis = 0; axis < 3; ++axis) {
      const double off = 2 * scenes::uniform(seed, static_cast<std::uint64_t>(3 * e + axis)) - 1;
      nodes.at[4 + e][axis] =
          0.5 * (nodes.at[end_of_edge(e, 0)][axis] + nodes.at[end_of_edge(e, 1)][axis]) +
          bend * off;
    }
  }
  return nodes;
}

/// The sum over ten nodes of their shape functions.
void expected_place(const CurveNodes& nodes, const double* u, double* x) {
  const double l[4] = {1 - u[0] - u[1] - u[2], u[0], u[1], u[2]};
  for (int axis = 0; axis < 3; ++axis) {
    x[axis] = 0;
    for (int a = 0; a < 4; ++a) x[axis] += l[a] * (2 * l[a] - 1) * nodes.at[a][axis];
    for (int e = 0; e < 6; ++e) {
      x[axis] += 4 * l[end_of_edge(e, 0)] * l[end_of_edge(e, 1)] * nodes.at[4 + e][axis];
    }
  }
}

/// A place within the tetrahedron.
void random_place(std::uint64_t seed, double* u) {
  double sum = 0, share[4];
  for (std::uint64_t a = 0; a < 4; ++a) sum += share[a] = 0.05 + scenes::uniform(seed, a);
  for (int a = 0; a < 3; ++a) u[a] = share[a + 1] / sum;
}

TEST(CurveMap, IsTheSumOfShapeFunctionsWithItsGradient) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const CurveNodes nodes = bent_nodes(2, seed);
    double u[3], x[3], expected[3];
    random_place(seed + 1000, u);
    Matrix3 gradient;
    map_curve(curve_terms(nodes), u, x, gradient);
    expected_place(nodes, u, expected);
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(x[axis], expected[axis], 1e-13);
    for (int by = 0; by < 3; ++by) {
      constexpr double step = 1e-3;  // differences of a quadratic are exact
      double up[3] = {u[0], u[1], u[2]}, down[3] = {u[0], u[1], u[2]}, above[3], below[3];
      up[by] += step;
      down[by] -= step;
      expected_place(nodes, up, above);
      expected_place(nodes, down, below);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(gradient.at[axis][by], (above[axis] - below[axis]) / (2 * step), 1e-9);
      }
    }
  }
}

/// From the coordinates in the straight tetrahedron back to those of the curved one.
TEST(CurveMap, IsInvertedWhereItIsNotFolded) {
  for (const double bend : {0.0, 0.1, 0.5}) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      const CurveTerms curve = curve_terms(bent_nodes(bend, seed));
      const CurveTerms straight = curve_terms(bent_nodes(0, seed));
      double u[3], x[3], found[3], from[3];
      random_place(seed + 2000, u);
      Matrix3 gradient;
      map_curve(curve, u, x, gradient);
      map_curve(straight, u, from, gradient);
      for (int axis = 0; axis < 3; ++axis) from[axis] = x[axis] - from[axis];
      ASSERT_TRUE(newton_step(gradient, from, found));
      for (int axis = 0; axis < 3; ++axis) found[axis] += u[axis];

      ASSERT_TRUE(invert_curve(curve, x, found)) << bend << " " << seed;

      for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], u[axis], 1e-9);
    }
  }
}

/// All nodes in a plane; a middle node beyond the far end of its edge, which folds the map; a place
/// that is farther away than the map reaches; numbers that are none.
TEST(CurveMap, HasNoInverseWhereItIsFoldedOrFarAway) {
  CurveNodes flat = bent_nodes(0, 1), folded = bent_nodes(0, 1);
  for (auto& node : flat.at) node[2] = 0;
  for (int axis = 0; axis < 3; ++axis) {
    folded.at[4][axis] = 2 * folded.at[1][axis] - folded.at[0][axis];
  }
  const CurveTerms straight = curve_terms(bent_nodes(0, 1));
  double u[3] = {0.9, 0.03, 0.03}, x[3];
  Matrix3 gradient;
  map_curve(curve_terms(folded), u, x, gradient);
  EXPECT_FALSE(invert_curve(curve_terms(folded), x, u));
  double center[3] = {0.25, 0.25, 0.25};
  EXPECT_FALSE(invert_curve(curve_terms(flat), x, center));
  for (const double far : {100.0, 1e30, double{INFINITY}, double{NAN}}) {
    const double target[3] = {far, 0, 0};
    std::fill_n(center, 3, 0.25);
    EXPECT_FALSE(invert_curve(straight, target, center)) << far;
  }
}

}  // namespace
}  // namespace tetwarp::test

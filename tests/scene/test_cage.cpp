/// @file test_cage.cpp
/// Harmonic weights of cages: not negative, of sum 1, linear maps, turns without inversion.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/scene/shapes/cage.hpp"
#include "tests/scene/surface_checks.hpp"

namespace tetwarp {
namespace {
struct CageCase {
  std::array<std::int64_t, 3> cells;
  std::size_t vertices;
  Point3 size;
};
const std::vector<CageCase> cage_cases{{{1, 1, 1}, 8, {1, 1, 1}},
                                       {{2, 2, 2}, 26, {1, 1, 1}},
                                       {{3, 3, 3}, 56, {1, 1, 1}},
                                       {{2, 1, 3}, 24, {0.3, 0.17, 0.22}}};

/// Points of a lattice in the box of a case, some of them on its faces.
TetMesh lattice_in(const Point3& size) {
  return make_lattice(fitted_frame({{0, 0, 0}, size}, {5, 4, 7}));
}

TEST(Cage, WeightsAreNotNegativeAndOfSumOne) {
  for (const auto& [cells, vertices, size] : cage_cases) {
    const TetMesh mesh = lattice_in(size);

    const CageWeights cage = make_cage_weights("body", {{0, 0, 0}, size}, cells, 4, mesh.nodes);

    ASSERT_EQ(cage.vertices.size(), vertices);
    for (std::size_t p = 0; p < mesh.nodes.size(); ++p) {
      double sum = 0;
      for (std::size_t v = 0; v < vertices; ++v) {
        ASSERT_GE(cage.weight[p * vertices + v], -1e-14);
        sum += cage.weight[p * vertices + v];
      }
      ASSERT_NEAR(sum, 1, 1e-13);
    }
  }
}

TEST(Cage, ReproducesLinearMaps) {
  const auto map = [](const Point3& x) {
    return Point3{0.3 * x[0] - 2 * x[1] + 0.1, x[0] + x[2] - 3, 0.7 * x[1] - 0.2 * x[2]};
  };
  for (const auto& [cells, vertices, size] : cage_cases) {
    const TetMesh mesh = lattice_in(size);
    const CageWeights cage = make_cage_weights("body", {{0, 0, 0}, size}, cells, 4, mesh.nodes);
    std::vector<Point3> moved;
    for (const Point3& vertex : cage.vertices) moved.push_back(map(vertex));

    const std::vector<Point3> points = caged_points(cage, moved);

    for (std::size_t p = 0; p < points.size(); ++p) {
      ASSERT_LT(norm(minus(points[p], map(mesh.nodes[p]))), 1e-13);
    }
  }
}

/// A twist by 60 degrees from end to end leaves det F of all tetrahedra above 0.7.
TEST(Cage, TwistsWithoutInversion) {
  const CageCase& box = cage_cases[0];
  const TetMesh mesh = lattice_in(box.size);
  const CageWeights cage =
      make_cage_weights("body", {{0, 0, 0}, box.size}, {1, 1, 1}, 8, mesh.nodes);
  std::vector<Point3> moved;
  for (const Point3& x : cage.vertices) {
    const double angle = std::numbers::pi / 3 * (x[2] - 0.5), u = x[0] - 0.5, v = x[1] - 0.5;
    moved.push_back({std::cos(angle) * u - std::sin(angle) * v,
                     std::sin(angle) * u + std::cos(angle) * v, x[2]});
  }

  TetMesh twisted{caged_points(cage, moved), mesh.tets};

  const auto before = scene_checks::volumes_of(mesh.nodes, mesh.tets);
  const auto after = scene_checks::volumes_of(twisted.nodes, twisted.tets);
  for (std::size_t t = 0; t < before.size(); ++t) EXPECT_GT(after[t] / before[t], 0.7);
}
}  // namespace
}  // namespace tetwarp

/// @file test_lattice_mesh.cpp
/// The embedding lattice: faces match, volumes add up, foreground is covered; what is foreground.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <tetwarp/make.hpp>
#include <utility>
#include <vector>

#include "host/base/sample_level.hpp"
#include "tests/support/make_checks.hpp"

namespace tetwarp {
namespace {
using Eigen::Vector3d;
using make_checks::contains;
using make_checks::lattice_of;
using make_checks::message_of;
using make_checks::PixelTypes;
using make_checks::smallest_volume;
using make_checks::tet_volumes;
using make_checks::vector_of;

double total_volume(const Mesh& mesh) {
  double sum = 0;
  for (const double volume : tet_volumes(mesh, mesh.rest_positions)) sum += volume;
  return sum;
}

/// How often each face occurs outwards: sorted nodes, then (even, odd) order counts.
std::map<std::array<std::int32_t, 3>, std::array<int, 2>> faces_of(const Mesh& mesh) {
  constexpr int outward[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  std::map<std::array<std::int32_t, 3>, std::array<int, 2>> faces;
  for (const auto& tet : mesh.tets) {
    for (const auto& corners : outward) {
      std::array<std::int32_t, 3> face;
      for (std::size_t n = 0; n < 3; ++n) face[n] = tet[static_cast<std::size_t>(corners[n])];
      int swaps = 0;
      for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{1u, 2u}, std::pair{0u, 1u}}) {
        if (face[a] < face[b]) continue;
        std::swap(face[a], face[b]);
        ++swaps;
      }
      ++faces[face][static_cast<std::size_t>(swaps % 2)];
    }
  }
  return faces;
}

bool is_in_closed_tet(const Mesh& mesh, const std::array<std::int32_t, 4>& tet, const Vector3d& x) {
  Eigen::Matrix4d nodes;
  for (int n = 0; n < 4; ++n) {
    nodes.col(n) << vector_of(
        mesh.rest_positions[static_cast<std::size_t>(tet[static_cast<std::size_t>(n)])]),
        1;
  }
  const Eigen::Vector4d barycentric = nodes.partialPivLu().solve(x.homogeneous());
  return barycentric.minCoeff() > -1e-9;
}

bool is_covered(const Mesh& mesh, const Point3& x) {
  return std::any_of(mesh.tets.begin(), mesh.tets.end(),
                     [&](const auto& tet) { return is_in_closed_tet(mesh, tet, vector_of(x)); });
}

/// 9 x 7 x 5 voxels, oblique, uneven spacing, axes of uneven length.
Grid oblique_grid(double handedness) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.6, Vector3d(1, 2, -1).normalized()).toRotationMatrix() *
      Vector3d(1, handedness, 1.5).asDiagonal();
  Grid grid;
  grid.dims = {9, 7, 5};
  grid.spacing = {1.5, 2, 1.25};
  grid.origin = {-40, 7, 300};
  for (int row = 0; row < 3; ++row) {
    for (int axis = 0; axis < 3; ++axis) {
      grid.direction[static_cast<std::size_t>(3 * row + axis)] = turn(row, axis);
    }
  }
  return grid;
}

/// An L of ones in two arms of the grid.
template <class T>
Volume bent_bar(const Grid& grid, int components) {
  Volume volume = make_volume(grid, pixel_type_of<T>(), components);
  const auto samples = volume.samples<T>();
  for (std::int64_t k = 0; k < grid.dims[2]; ++k) {
    for (std::int64_t j = 0; j < grid.dims[1]; ++j) {
      for (std::int64_t i = 0; i < grid.dims[0]; ++i) {
        if (k != 1 || (i > 1 && j > 0)) continue;
        const std::int64_t voxel = (k * grid.dims[1] + j) * grid.dims[0] + i;
        // Only the last component is above the threshold.
        samples[static_cast<std::size_t>((voxel + 1) * components - 1)] = T{1};
      }
    }
  }
  return volume;
}

TEST(Lattice, FacesMatchAndVolumesAddUp) {
  for (const double handedness : {1.0, -1.0}) {
    const Mesh mesh = lattice_of(bent_bar<float>(oblique_grid(handedness), 1), 4);
    check_mesh(mesh);
    EXPECT_GT(smallest_volume(mesh, mesh.rest_positions), 0);
    int boundary = 0;
    for (const auto& [face, counts] : faces_of(mesh)) {
      ASSERT_LE(counts[0], 1);
      ASSERT_LE(counts[1], 1);
      boundary += counts[0] + counts[1] == 1;
    }
    // Two triangles on each of the outer squares of 4 x c1 x c2 cells.
    const double edge = 14.0 / 4;  // the second axis, 7 voxels of 2, is the longest
    const int cells0 = 4;          // 13.5 / 3.5 rounded up
    const int cells2 = 3;          // 5 * 1.25 * 1.5 = 9.375, / 3.5 rounded up
    EXPECT_EQ(boundary, 4 * (cells0 * 4 + cells0 * cells2 + 4 * cells2));
    EXPECT_NEAR(total_volume(mesh), cells0 * 4 * cells2 * edge * edge * edge, 1e-9);
  }
}

TEST(Lattice, CoversEveryVoxelToItsCorners) {
  const Grid grid = oblique_grid(1);
  const Mesh mesh = lattice_of(make_volume(grid, PixelType::int16), 3);
  for (const double i : {-0.5, 0.0, 4.3, 8.5}) {
    for (const double j : {-0.5, 3.0, 6.5}) {
      for (const double k : {-0.5, 2.2, 4.5}) {
        EXPECT_TRUE(is_covered(mesh, grid.world_of({i, j, k}))) << i << ' ' << j << ' ' << k;
      }
    }
  }
}

template <class T>
class LatticeOf : public ::testing::Test {};
TYPED_TEST_SUITE(LatticeOf, PixelTypes);

TYPED_TEST(LatticeOf, DropsEmptyCellsAndKeepsForeground) {
  const Grid grid = oblique_grid(-1);
  for (const int components : {1, 3}) {
    const Volume volume = bent_bar<TypeParam>(grid, components);
    const Mesh mesh = lattice_of(volume, 7, 0.5);
    EXPECT_GT(smallest_volume(mesh, mesh.rest_positions), 0);
    const Mesh whole = lattice_of(volume, 7);
    EXPECT_LT(mesh.tets.size(), whole.tets.size() / 3);
    std::set<std::int32_t> used;
    for (const auto& tet : mesh.tets) used.insert(tet.begin(), tet.end());
    EXPECT_EQ(used.size(), mesh.rest_positions.size());
    for (double i = 0; i < 9; ++i) EXPECT_TRUE(is_covered(mesh, grid.world_of({i, 0, 1})));
    for (double j = 0; j < 7; ++j) EXPECT_TRUE(is_covered(mesh, grid.world_of({1, j, 1})));
    EXPECT_FALSE(is_covered(mesh, grid.world_of({6, 5, 1})));
  }
}

TEST(Lattice, CellsSmallerThanVoxelsLeaveNoGap) {
  Grid grid;
  grid.dims = {3, 2, 2};
  const Mesh mesh = lattice_of(make_volume(grid, PixelType::uint8), 9);
  EXPECT_EQ(mesh.tets.size(), 5u * 9 * 6 * 6);
  EXPECT_NEAR(total_volume(mesh), 12, 1e-12);
}

TEST(Lattice, BadArgumentsAreNamed) {
  Volume volume = make_volume(oblique_grid(1), PixelType::float32);
  EXPECT_TRUE(contains(message_of([&] { lattice_of(volume, 0); }), "0 cells"));
  EXPECT_TRUE(contains(message_of([&] { lattice_of(volume, 1 << 20); }), "2^31"));
  EXPECT_TRUE(contains(message_of([&] { lattice_of(volume, 8, 0.5); }),
                       "no voxel of 'values' is above 0.5"));
  std::fill(volume.samples<float>().begin(), volume.samples<float>().end(),
            std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW(lattice_of(volume, 8, -1), std::invalid_argument);
  volume.data.resize(8);
  EXPECT_THROW(make_lattice_mesh(volume), std::invalid_argument);
}

TEST(Lattice, HexahedraAreItsCellsRightSideOut) {
  for (const double handedness : {1.0, -1.0}) {
    const Volume volume = make_volume(oblique_grid(handedness), PixelType::float32);
    const Mesh tets = make_lattice_mesh(volume, {.cells = 4});
    const Mesh cells = make_lattice_mesh(volume, {.cells = 4, .hexahedra = true});
    EXPECT_EQ(cells.rest_positions, tets.rest_positions);
    EXPECT_EQ(5 * cells.hexes.size(), tets.tets.size());
    EXPECT_TRUE(cells.tets.empty());
    for (const auto& hex : cells.hexes) {
      const auto corner = [&](std::size_t n) {
        return vector_of(cells.rest_positions[static_cast<std::size_t>(hex[n])]);
      };
      const Vector3d x = corner(1) - corner(0), y = corner(3) - corner(0),
                     z = corner(4) - corner(0);
      EXPECT_GT(x.cross(y).dot(z), 0);
      EXPECT_LT((corner(6) - corner(0) - x - y - z).norm(), 1e-9);
      EXPECT_LT((corner(2) - corner(0) - x - y).norm(), 1e-9);
    }
  }
}

template <class T>
class SampleLevel : public ::testing::Test {};
using WideTypes = ::testing::Types<std::int64_t, std::uint64_t>;
TYPED_TEST_SUITE(SampleLevel, WideTypes);

/// Whole thresholds of this type, as far as float64 has them, and samples beside them.
TYPED_TEST(SampleLevel, HasTheSignOfAnExactComparison) {
  std::mt19937_64 random(5);
  std::uniform_int_distribution<int> shift(0, 62), step(-3, 3);
  int beside = 0;
  for (int n = 0; n < 20000; ++n) {
    const auto whole = static_cast<TypeParam>(random() >> (1 + shift(random)));
    const auto threshold = static_cast<double>(whole);
    const auto center = static_cast<TypeParam>(threshold);
    const auto sample = static_cast<TypeParam>(center + static_cast<TypeParam>(step(random)));
    const double level = level_of(sample, threshold);
    ASSERT_EQ(level > 0, std::cmp_greater(sample, center)) << sample << ' ' << threshold;
    ASSERT_EQ(level < 0, std::cmp_less(sample, center)) << sample << ' ' << threshold;
    beside += sample != center && static_cast<double>(sample) == threshold;
  }
  EXPECT_GT(beside, 1000);  // rounding would have hidden the difference
}

TYPED_TEST(SampleLevel, IsExactBesideFractionsAndAtTheLimits) {
  using Limits = std::numeric_limits<TypeParam>;
  const TypeParam sample = TypeParam{1} << 50;
  EXPECT_EQ(level_of(sample, 0x1p50 - 0.25), 0.25);
  EXPECT_EQ(level_of(sample, 0x1p50 + 0.25), -0.25);
  EXPECT_LT(level_of(Limits::max(), static_cast<double>(Limits::max())), 0);  // rounded up
  EXPECT_EQ(level_of(Limits::min(), static_cast<double>(Limits::min())), 0);
  EXPECT_LT(level_of(Limits::max(), 1e300), 0);
  EXPECT_GT(level_of(Limits::min(), -1e300), 0);
}

TEST(SampleLevelOfFloats, IsTheirDifference) {
  EXPECT_EQ(level_of(0.75F, 0.5), 0.25);
  EXPECT_EQ(level_of(std::uint8_t{3}, 5), -2);
  EXPECT_TRUE(std::isnan(level_of(std::nan(""), 0)));
}
}  // namespace
}  // namespace tetwarp

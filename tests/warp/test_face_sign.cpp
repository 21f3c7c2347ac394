/// @file test_face_sign.cpp
/// The exact side of a face: closed, for both orientations, up to the largest tetrahedra.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "kernels/warp/face_sign.hpp"
#include "tests/support/brute_force.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
TetNodes nodes_of(const TetQuanta& tet) {
  TetNodes nodes;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t axis = 0; axis < 3; ++axis) nodes.x[a][axis] = tet[a][axis];
  }
  return nodes;
}

/// Legs of `size` quanta along the axes from a corner.
TetQuanta corner_tet(std::int64_t size, const Quanta& at = {0, 0, 0}) {
  TetQuanta tet = {at, at, at, at};
  for (std::size_t axis = 0; axis < 3; ++axis) tet[axis + 1][axis] += size;
  return tet;
}

std::int64_t owned_voxels(const TetNodes& tet, int edge, bool strictly) {
  std::int64_t owned = 0;
  for (int k = -1; k <= edge; ++k) {
    for (int j = -1; j <= edge; ++j) {
      for (int i = -1; i <= edge; ++i) owned += is_inside_exact(tet, i, j, k, strictly);
    }
  }
  return owned;
}

TEST(FaceSign, CountsNodesEdgesAndFacesAsInside) {
  const TetNodes tet = nodes_of(corner_tet(4 * quanta));

  EXPECT_TRUE(is_inside_exact(tet, 0, 0, 0));
  EXPECT_TRUE(is_inside_exact(tet, 2, 0, 0));
  EXPECT_TRUE(is_inside_exact(tet, 1, 1, 2));
  EXPECT_TRUE(is_inside_exact(tet, 1, 1, 1));
  EXPECT_FALSE(is_inside_exact(tet, 2, 2, 1));
  EXPECT_FALSE(is_inside_exact(tet, -1, 0, 0));
}

TEST(FaceSign, StrictlyLeavesOutTheSurface) {
  const TetNodes tet = nodes_of(corner_tet(4 * quanta));

  EXPECT_TRUE(is_inside_exact(tet, 1, 1, 1, true));
  EXPECT_FALSE(is_inside_exact(tet, 0, 0, 0, true));
  EXPECT_FALSE(is_inside_exact(tet, 2, 0, 0, true));
  EXPECT_FALSE(is_inside_exact(tet, 1, 1, 2, true));
}

/// A corner tetrahedron with legs of n voxels holds (n+1)(n+2)(n+3)/6 points, (n-1)(n-2)(n-3)/6 of
/// them strictly inside.
TEST(FaceSign, FindsTheTetrahedralNumbers) {
  for (const std::int64_t n : {1, 2, 31, 32, 33}) {
    const TetNodes tet = nodes_of(corner_tet(n * quanta));
    const int edge = static_cast<int>(n) + 1;
    EXPECT_EQ(owned_voxels(tet, edge, false), (n + 1) * (n + 2) * (n + 3) / 6);
    EXPECT_EQ(owned_voxels(tet, edge, true), (n - 1) * (n - 2) * (n - 3) / 6);
  }
}

TEST(FaceSign, ResolvesASingleQuantum) {
  const TetNodes touching = nodes_of(corner_tet(3 * quanta));
  const TetNodes short_of = nodes_of(corner_tet(3 * quanta - 1));
  const TetNodes past = nodes_of(corner_tet(3 * quanta + 1));

  EXPECT_TRUE(is_inside_exact(touching, 1, 1, 1));
  EXPECT_FALSE(is_inside_exact(short_of, 1, 1, 1));
  EXPECT_FALSE(is_inside_exact(touching, 1, 1, 1, true));
  EXPECT_TRUE(is_inside_exact(past, 1, 1, 1, true));
}

TEST(FaceSign, DoesNotDependOnTheOrderOfNodes) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    TetQuanta tet;
    for (std::size_t at = 0; at < 12; ++at) {
      tet[at / 3][at % 3] =
          static_cast<std::int64_t>(8 * quanta * scenes::uniform(seed, at)) / 4096 * 4096;
    }
    std::ranges::sort(tet);
    const std::int64_t owned = owned_voxels(nodes_of(tet), 8, false);
    while (std::ranges::next_permutation(tet).found) {
      ASSERT_EQ(owned_voxels(nodes_of(tet), 8, false), owned) << "seed " << seed;
    }
  }
}

TEST(FaceSign, AgreesWithBruteForceOnEveryVoxel) {
  int inside = 0;
  for (std::uint64_t seed = 100; seed < 300; ++seed) {
    TetQuanta tet;
    for (std::size_t at = 0; at < 12; ++at) {
      // Every other tetrahedron has whole voxels as nodes, and with them many voxels on its faces.
      const double x = 7 * scenes::uniform(seed, at);
      tet[at / 3][at % 3] = static_cast<std::int64_t>((seed % 2 == 0 ? x : std::floor(x)) * quanta);
    }
    const TetNodes nodes = nodes_of(tet);
    for (int v = 0; v < 512; ++v) {
      const int i = v & 7, j = v >> 3 & 7, k = v >> 6;
      ASSERT_EQ(is_inside_exact(nodes, i, j, k), is_inside(tet, voxel_center(i, j, k)));
      inside += is_inside_exact(nodes, i, j, k);
    }
  }
  EXPECT_GT(inside, 1000);
}

TEST(FaceSign, GivesFlatTetrahedraNothing) {
  const TetQuanta plane = {
      {{0, 0, 0}, {4 * quanta, 0, 0}, {0, 4 * quanta, 0}, {quanta, quanta, 0}}};
  const TetQuanta line = {
      {{0, 0, 0}, {quanta, quanta, 0}, {2 * quanta, 2 * quanta, 0}, {3 * quanta, 3 * quanta, 0}}};
  const TetQuanta point = corner_tet(0);

  for (const TetQuanta& tet : {plane, line, point}) {
    EXPECT_EQ(owned_voxels(nodes_of(tet), 5, false), 0);
  }
}

TEST(FaceSign, HoldsTheLargestTetrahedron) {
  constexpr int edge = 1 << 20;  // voxels, 2^40 quanta
  for (const std::int64_t origin : {std::int64_t{0}, -edge / 2 * quanta}) {
    const TetNodes tet = nodes_of(corner_tet(longest_extent, {origin, origin, origin}));
    const int o = static_cast<int>(origin / quanta);

    EXPECT_TRUE(is_inside_exact(tet, o + edge / 2, o + edge / 4, o + edge / 4));
    EXPECT_FALSE(is_inside_exact(tet, o + edge / 2, o + edge / 4, o + edge / 4, true));
    EXPECT_FALSE(is_inside_exact(tet, o + edge / 2, o + edge / 4, o + edge / 4 + 1));
    EXPECT_TRUE(is_inside_exact(tet, o + edge / 2, o + edge / 4 - 1, o + edge / 4, true));
    EXPECT_FALSE(is_inside_exact(tet, o - 16, o + edge + 16, o));
  }
}

/// Six times the volume of a regular tetrahedron in a cube of 2^40 quanta: 2 * 2^120.
TEST(FaceSign, MeasuresTheLargestVolume) {
  const std::int64_t e = longest_extent;
  const TetNodes tet = nodes_of({{{0, 0, 0}, {e, e, 0}, {e, 0, e}, {0, e, e}}});

  for (int face = 0; face < 4; ++face) {
    ExactPlane plane = exact_plane(tet, face);
    EXPECT_TRUE(turn_inward(plane, tet, face) == Int128{2} << 120);
    EXPECT_TRUE(plane_value(plane, tet.x[face]) == Int128{2} << 120);
  }
}
}  // namespace
}  // namespace tetwarp::test

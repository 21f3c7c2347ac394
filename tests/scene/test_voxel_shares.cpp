/// @file test_voxel_shares.cpp
/// Shares of tetrahedra in the boxes of voxels, and integrals over them.
#include "host/scene/voxel_shares.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "host/scene/shapes/lattice.hpp"

namespace tetwarp {
namespace {
using Corners = std::array<Point3, 4>;

constexpr Region eight{{0, 0, 0}, {8, 8, 8}};
const auto any_voxel = [](const VoxelIndex&) { return true; };

/// The sum of all N_a N_b, in which off-diagonal products count twice.
double sum_of(const VoxelShare& share) {
  double sum = 0;
  std::size_t k = 0;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t b = a; b < 4; ++b) sum += (a == b ? 1 : 2) * share.product[k++];
  }
  return sum;
}

TEST(VoxelShares, OfATetrahedronInAVoxelAreItsOwnIntegrals) {
  const Corners tet{{{2.7, 3, 4}, {3.3, 3.1, 4}, {3, 3.4, 4.1}, {3, 3, 4.4}}};
  const double volume = tet_volume(tet[0], tet[1], tet[2], tet[3]);
  int count = 0;

  for_shares(tet, eight, any_voxel, [&](const VoxelIndex& voxel, const VoxelShare& share) {
    ++count;
    EXPECT_EQ(voxel, (VoxelIndex{3, 3, 4}));
    EXPECT_NEAR(share.volume, volume, 1e-15);
    std::size_t k = 0;
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = a; b < 4; ++b) {
        EXPECT_NEAR(share.product[k++], volume * (a == b ? 2 : 1) / 20, 1e-15);
      }
    }
    return true;
  });

  EXPECT_EQ(count, 1);
}

/// In the corner tetrahedron of [-1, 5]^3 the voxel at the origin is whole: N_1 is (x + 1) / 6.
TEST(VoxelShares, OfAWholeVoxelAreIntegralsOverItsBox) {
  const Corners tet{{{-1, -1, -1}, {5, -1, -1}, {-1, 5, -1}, {-1, -1, 5}}};

  for_shares(
      tet, eight,
      [](const VoxelIndex& voxel) {
        return voxel == VoxelIndex{0, 0, 0};
      },
      [&](const VoxelIndex&, const VoxelShare& share) {
        EXPECT_EQ(share.volume, 1);
        EXPECT_NEAR(share.product[4], (1 + 1.0 / 12) / 36, 1e-15);
        EXPECT_NEAR(share.product[5], 1.0 / 36, 1e-15);
        EXPECT_NEAR(share.product[0], 9.0 / 36 + 3.0 / 12 / 36, 1e-15);
        return true;
      });
}

/// Shares in all voxels add up to the integrals of the tetrahedron.
TEST(VoxelShares, OfRandomTetrahedraAddUpToTheirIntegrals) {
  std::mt19937 random(11);
  for (const double size : {0.05, 1.0, 8.0}) {
    std::uniform_real_distribution<double> place(0, size);
    for (int trial = 0; trial < 100; ++trial) {
      Corners tet;
      for (Point3& x : tet) {
        for (double& coordinate : x) coordinate = 7.5 - place(random);
      }
      const double volume = std::abs(tet_volume(tet[0], tet[1], tet[2], tet[3]));
      if (volume < 1e-3 * size * size * size) continue;
      VoxelShare sum;

      for_shares(tet, eight, any_voxel, [&](const VoxelIndex&, const VoxelShare& share) {
        EXPECT_LE(share.volume, 1 + 1e-12);
        EXPECT_NEAR(sum_of(share), share.volume, 1e-11 * std::min(1.0, volume));
        sum.volume += share.volume;
        for (std::size_t k = 0; k < 10; ++k) sum.product[k] += share.product[k];
        return true;
      });

      EXPECT_NEAR(sum.volume / volume, 1, 1e-9);
      std::size_t k = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        for (std::size_t b = a; b < 4; ++b) {
          EXPECT_NEAR(sum.product[k++] / volume, (a == b ? 2 : 1) / 20.0, 1e-9);
        }
      }
    }
  }
}

/// Tetrahedra of a lattice share each voxel that it covers to 1, and no voxel to more.
TEST(VoxelShares, OfALatticeAddUpToOneInEveryVoxel) {
  for (const Point3& edge : {Point3{0.7, 0.9, 1.3}, Point3{2.3, 1.1, 0.4}, Point3{5, 5, 5}}) {
    const LatticeFrame frame = covering_frame({{0.5, 0.5, 0.5}, {7.2, 7.5, 6.5}}, edge, 0);
    const TetMesh mesh = make_lattice(frame);
    std::vector<double> sums(512);
    for (const auto& [a, b, c, d] : mesh.tets) {
      for_shares({at(mesh.nodes, a), at(mesh.nodes, b), at(mesh.nodes, c), at(mesh.nodes, d)},
                 eight, any_voxel, [&](const VoxelIndex& voxel, const VoxelShare& share) {
                   const auto [i, j, k] = voxel;
                   sums[static_cast<std::size_t>((k * 8 + j) * 8 + i)] += share.volume;
                   return true;
                 });
    }

    for (std::size_t v = 0; v < sums.size(); ++v) {
      EXPECT_LE(sums[v], 1 + 1e-9);
      const std::array<std::size_t, 3> ijk{v % 8, v / 8 % 8, v / 64};
      const bool is_covered =
          std::ranges::all_of(ijk, [](std::size_t n) { return n > 0 && n < 7; });
      if (is_covered) {
        EXPECT_NEAR(sums[v], 1, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace tetwarp

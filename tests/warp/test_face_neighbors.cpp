/// @file test_face_neighbors.cpp
/// Tetrahedra that share faces: by hand, and in a lattice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/warp/cpu/face_neighbors.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
std::vector<std::int32_t> neighbors_of(const std::vector<std::int32_t>& tets,
                                       const std::vector<double>& volumes) {
  return face_neighbors({tets.data(), std::ssize(tets)}, volumes);
}

/// Nodes 1, 2 and 3 are shared; 0 and 4 lie on two sides of them where the volumes agree with that.
TEST(FaceNeighbors, AreThoseOnTheOtherSideAtRest) {
  const std::vector<std::int32_t> tets{0, 1, 2, 3, 4, 1, 2, 3};
  const std::vector<std::int32_t> none(8, -1), both{1, -1, -1, -1, 0, -1, -1, -1};
  EXPECT_EQ(neighbors_of(tets, {1, -2}), both);
  EXPECT_EQ(neighbors_of(tets, {1, 2}), none);   // on the same side
  EXPECT_EQ(neighbors_of(tets, {0, -2}), none);  // one is flat
  EXPECT_EQ(neighbors_of({}, {}), std::vector<std::int32_t>{});
}

TEST(FaceNeighbors, AreThoseForEveryOrderOfNodes) {
  std::vector<std::int32_t> order{4, 1, 2, 3};
  std::ranges::sort(order);
  do {
    int inversions = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b)
        inversions += order[static_cast<std::size_t>(b)] > order[static_cast<std::size_t>(a)];
    }
    // 1 2 3 4 is 4 1 2 3 after three exchanges.
    const double volume = inversions % 2 == 0 ? 1.0 : -1.0;
    std::vector<std::int32_t> tets{0, 1, 2, 3};
    tets.insert(tets.end(), order.begin(), order.end());
    const auto found = neighbors_of(tets, {1, volume});
    const auto face = std::ranges::find(order, 4) - order.begin();
    EXPECT_EQ(found[0], 1);
    EXPECT_EQ(found[static_cast<std::size_t>(4 + face)], 0);
    EXPECT_EQ(std::ranges::count(found, -1), 6);
  } while (std::ranges::next_permutation(order).found);
}

TEST(FaceNeighbors, OfAFaceOfThreeAreNone) {
  const auto found = neighbors_of({0, 1, 2, 3, 4, 1, 2, 3, 5, 1, 2, 3}, {1, -1, -1});
  EXPECT_EQ(std::ranges::count(found, -1), 12);
}

/// 24 outer squares of two triangles; each neighbor has its neighbor.
TEST(FaceNeighbors, OfALatticeAreAllButTheHull) {
  const Mesh mesh = scenes::lattice({2, 2, 2}, {0, 0, 0}, {1, 1, 1});
  std::vector<std::int32_t> tets;
  std::vector<double> volumes;
  for (const auto& tet : mesh.tets) {
    tets.insert(tets.end(), tet.begin(), tet.end());
    double side[3][3];
    for (std::size_t n = 0; n < 3; ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        side[n][axis] = mesh.rest_positions[static_cast<std::size_t>(tet[n + 1])][axis] -
                        mesh.rest_positions[static_cast<std::size_t>(tet[0])][axis];
      }
    }
    volumes.push_back(side[0][0] * (side[1][1] * side[2][2] - side[1][2] * side[2][1]) -
                      side[0][1] * (side[1][0] * side[2][2] - side[1][2] * side[2][0]) +
                      side[0][2] * (side[1][0] * side[2][1] - side[1][1] * side[2][0]));
  }
  const auto found = neighbors_of(tets, volumes);
  EXPECT_EQ(std::ranges::count(found, -1), 48);
  for (std::size_t f = 0; f < found.size(); ++f) {
    if (found[f] < 0) continue;
    const auto other = found.begin() + 4 * found[f];
    EXPECT_EQ(std::count(other, other + 4, static_cast<std::int32_t>(f / 4)), 1);
  }
}
}  // namespace
}  // namespace tetwarp::test

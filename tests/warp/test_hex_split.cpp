/// @file test_hex_split.cpp
/// Hexahedra split into tetrahedra: without gap or overlap, and with equal cuts on shared faces.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "host/warp/hex_split.hpp"
#include "tests/support/hex_scenes.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// Nodes under seeded new numbers, so that the lowest of a hexahedron is any of its corners.
void renumber(HexBox& box, std::uint64_t seed) {
  std::vector<std::int32_t> number(box.mesh.rest_positions.size());
  for (std::size_t n = 0; n < number.size(); ++n) number[n] = static_cast<std::int32_t>(n);
  for (std::size_t n = number.size() - 1; n > 0; --n) {
    const double at = scenes::uniform(seed, n) * static_cast<double>(n + 1);
    std::swap(number[n], number[static_cast<std::size_t>(at)]);
  }
  const HexBox old = box;
  for (std::size_t n = 0; n < number.size(); ++n) {
    const auto to = static_cast<std::size_t>(number[n]);
    box.mesh.rest_positions[to] = old.mesh.rest_positions[n];
    box.deformed[to] = old.deformed[n];
  }
  for (auto& hex : box.mesh.hexes) {
    for (std::int32_t& node : hex) node = number[static_cast<std::size_t>(node)];
  }
}

TEST(HexSplit, FillsABoxWithTetrahedraThatMeetFaceToFace) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    HexBox box = hex_box({3, 2, 4}, {0, 0, 0}, {3, 2, 4}, bent(0.1));
    renumber(box, seed);
    const auto tets = split_hexes(box.mesh.hexes);
    ASSERT_EQ(tets.size(), 6u * 24u);
    double volume = 0;
    std::map<std::array<std::int32_t, 3>, int> uses;
    for (const auto& tet : tets) {
      std::array<Eigen::Vector3d, 4> x;
      for (std::size_t n = 0; n < 4; ++n) {
        const Point3& p = box.mesh.rest_positions[static_cast<std::size_t>(tet[n])];
        x[n] = {p[0], p[1], p[2]};
      }
      const double part = (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6;
      EXPECT_NEAR(part, 1.0 / 6, 1e-14);
      volume += part;
      for (std::size_t left_out = 0; left_out < 4; ++left_out) {
        std::array<std::int32_t, 3> face;
        for (std::size_t n = 0; n < 3; ++n) face[n] = tet[(left_out + 1 + n) % 4];
        std::sort(face.begin(), face.end());
        ++uses[face];
      }
    }
    EXPECT_NEAR(volume, 24, 1e-12);
    int outer = 0;
    for (const auto& [face, count] : uses) {
      EXPECT_LE(count, 2);
      outer += count == 1;
    }
    EXPECT_EQ(outer, 2 * 2 * (3 * 2 + 2 * 4 + 3 * 4)) << seed;
  }
}

TEST(HexMap, FindsThePlaceThatTheTrilinearMapTakesToAPoint) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    HexCorners hex;
    for (int a = 0; a < 8; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto draw = static_cast<std::uint64_t>(3 * a + axis);
        hex.at[a][axis] = 10 * (unit_corner(a, axis) + 0.5 * scenes::uniform(seed, draw));
      }
    }
    double expected[3], x[3], u[3] = {0.5, 0.5, 0.5};
    for (std::uint64_t axis = 0; axis < 3; ++axis) {
      expected[axis] = 1.2 * scenes::uniform(seed, 100 + axis) - 0.1;
    }
    Matrix3 gradient;
    map_hex(hex_terms(hex), expected, x, gradient);
    if (determinant(gradient) < 50) continue;  // of 1000 when it is a cube: nearly folded there

    invert_hex(hex_terms(hex), x, u);

    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(u[axis], expected[axis], 1e-9) << seed;
  }
}

TEST(HexMap, StaysWithinItsMarginHoweverTheHexahedronIsFolded) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    HexCorners hex;
    for (int a = 0; a < 8; ++a) {
      for (int axis = 0; axis < 3; ++axis) {
        const auto draw = static_cast<std::uint64_t>(3 * a + axis);
        hex.at[a][axis] = seed % 4 == 0 ? 0 : 10 * scenes::uniform(seed, draw);
      }
    }
    const double target[3] = {5, -3, 7};
    double u[3] = {0.1, 0.5, 0.9};

    invert_hex(hex_terms(hex), target, u);

    for (const double coordinate : u) {
      EXPECT_GE(coordinate, -hex_margin) << seed;
      EXPECT_LE(coordinate, 1 + hex_margin) << seed;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_deform_mesh.cpp
/// Procedural deformations against their geometry.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <tetwarp/make.hpp>
#include <vector>

#include "tests/support/make_checks.hpp"

namespace tetwarp {
namespace {
using Eigen::Vector3d;
using make_checks::contains;
using make_checks::lattice_of;
using make_checks::message_of;
using make_checks::smallest_volume;
using make_checks::vector_of;

Mesh cube_lattice(int cells) {
  Grid grid;
  grid.dims = {20, 20, 20};
  grid.origin = {3, -5, 11};
  return lattice_of(make_volume(grid, PixelType::uint8), cells);
}

constexpr std::array<Deformation, 6> all_kinds{Deformation::twist,  Deformation::bend,
                                               Deformation::swim,   Deformation::random,
                                               Deformation::rotate, Deformation::translate};

TEST(Deform, TimeZeroIsRestBitForBit) {
  Mesh mesh = cube_lattice(3);
  mesh.rest_positions[0][0] = -0.0;
  for (const Deformation kind : all_kinds) {
    const auto positions = deform_positions(mesh, {.kind = kind, .offset = {1, 2, 3}}, 0);
    ASSERT_EQ(positions.size(), mesh.rest_positions.size());
    EXPECT_EQ(std::memcmp(positions.data(), mesh.rest_positions.data(),
                          positions.size() * sizeof(Point3)),
              0)
        << name_of(kind);
  }
}

TEST(Deform, IsSmoothInTime) {
  const Mesh mesh = cube_lattice(3);
  for (const Deformation kind : all_kinds) {
    for (int axis = 0; axis < 3; ++axis) {
      const DeformOptions options{.kind = kind, .axis = axis, .offset = {4, 5, 6}};
      std::vector<Point3> before = mesh.rest_positions;
      double moved_at_all = 0;
      for (int step = 1; step <= 200; ++step) {
        const auto now = deform_positions(mesh, options, step / 200.0);
        for (std::size_t n = 0; n < now.size(); ++n) {
          const double moved = (vector_of(now[n]) - vector_of(before[n])).norm();
          ASSERT_LT(moved, 0.02 * 20) << name_of(kind) << " at step " << step;
          moved_at_all += moved;
        }
        before = now;
      }
      EXPECT_GT(moved_at_all, 10) << name_of(kind);
    }
  }
}

TEST(Deform, TwistTurnsTheEndsAQuarterApartAndKeepsTheDistanceToTheAxis) {
  const Mesh mesh = cube_lattice(4);
  const Vector3d center(12.5, 4.5, 20.5);
  for (int axis = 0; axis < 3; ++axis) {
    const auto positions = deform_positions(mesh, {.axis = axis}, 1);
    for (std::size_t n = 0; n < positions.size(); ++n) {
      Vector3d rest = vector_of(mesh.rest_positions[n]) - center;
      Vector3d now = vector_of(positions[n]) - center;
      EXPECT_DOUBLE_EQ(rest[axis], now[axis]);
      const double along = rest[axis] / 20;
      rest[axis] = now[axis] = 0;
      EXPECT_NEAR(rest.norm(), now.norm(), 1e-12);
      const double turned = rest.cross(now)[axis];
      EXPECT_NEAR(turned, rest.squaredNorm() * std::sin(along * std::numbers::pi / 2), 1e-9);
    }
  }
}

TEST(Deform, RotateIsRigidAndAQuarterTurn) {
  const Mesh mesh = cube_lattice(2);
  const auto positions = deform_positions(mesh, {.kind = Deformation::rotate, .axis = 1}, 1);
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vector3d rest = vector_of(mesh.rest_positions[n]) - Vector3d(12.5, 4.5, 20.5);
    const Vector3d now = vector_of(positions[n]) - Vector3d(12.5, 4.5, 20.5);
    EXPECT_NEAR((now - Vector3d(rest[2], rest[1], -rest[0])).norm(), 0, 1e-12);
  }
}

TEST(Deform, BendLaysTheAxisOnAQuarterCircle) {
  const Mesh mesh = cube_lattice(4);
  const auto positions = deform_positions(mesh, {.kind = Deformation::bend, .axis = 2}, 1);
  // A cube is too thick to keep the length of its middle: radius 0.75 of the thickness.
  const double radius = 15;
  for (std::size_t n = 0; n < positions.size(); ++n) {
    const Vector3d rest = vector_of(mesh.rest_positions[n]) - Vector3d(12.5, 4.5, 20.5);
    const Vector3d now = vector_of(positions[n]) - Vector3d(12.5 + radius, 4.5, 20.5);
    EXPECT_NEAR(std::hypot(now[0], now[2]), radius - rest[0], 1e-12);
    EXPECT_NEAR(std::atan2(now[2], -now[0]), rest[2] / 20 * std::numbers::pi / 2, 1e-12);
  }
}

TEST(Deform, TranslateMovesByTheOffset) {
  const Mesh mesh = cube_lattice(1);
  const DeformOptions options{.kind = Deformation::translate, .amount = 9, .offset = {2, -4, 8}};
  const auto positions = deform_positions(mesh, options, 0.5);
  for (std::size_t n = 0; n < positions.size(); ++n) {
    EXPECT_EQ(positions[n][0], mesh.rest_positions[n][0] + 1);
    EXPECT_EQ(positions[n][1], mesh.rest_positions[n][1] - 2);
    EXPECT_EQ(positions[n][2], mesh.rest_positions[n][2] + 4);
  }
}

TEST(Deform, RandomDependsOnTheSeedAlone) {
  const Mesh mesh = cube_lattice(2);
  const DeformOptions first{.kind = Deformation::random, .seed = 1};
  const DeformOptions second{.kind = Deformation::random, .seed = 2};
  const auto positions = deform_positions(mesh, first, 1);
  EXPECT_EQ(positions, deform_positions(mesh, first, 1));
  EXPECT_NE(positions, deform_positions(mesh, second, 1));
}

TEST(Deform, RandomStaysSmallAndTurnsNothingInsideOut) {
  const Mesh mesh = cube_lattice(10);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const auto positions = deform_positions(mesh, {.kind = Deformation::random, .seed = seed}, 1);
    EXPECT_GT(smallest_volume(mesh, positions), 0) << "seed " << seed;
    double largest = 0;
    for (std::size_t n = 0; n < positions.size(); ++n) {
      largest = std::max(
          largest,
          (vector_of(positions[n]) - vector_of(mesh.rest_positions[n])).lpNorm<Eigen::Infinity>());
    }
    EXPECT_LE(largest, 0.05 * 20) << "seed " << seed;
    EXPECT_GT(largest, 0.02 * 20) << "seed " << seed;
  }
}

TEST(Deform, NamesAreParsedBack) {
  for (const Deformation kind : all_kinds) EXPECT_EQ(parse<Deformation>(name_of(kind)), kind);
  EXPECT_EQ(message_of([] { parse<Deformation>("fold"); }),
            "'fold' is not one of twist, bend, swim, random, rotate, translate");
}

TEST(Deform, BadArgumentsAreNamed) {
  const Mesh mesh = cube_lattice(1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(contains(message_of([&] { deform_positions(mesh, {}, 1.5); }), "time 1.5"));
  EXPECT_TRUE(contains(message_of([&] { deform_positions(mesh, {}, nan); }), "time nan"));
  EXPECT_TRUE(contains(message_of([&] { deform_positions(mesh, {.axis = 3}, 1); }), "axis 3"));
  EXPECT_TRUE(contains(message_of([&] { deform_positions(mesh, {.amount = nan}, 1); }), "amount"));
  EXPECT_TRUE(contains(message_of([&] {
                         deform_positions(mesh, {.offset = {0, nan, 0}}, 1);
                       }),
                       "offset"));
  EXPECT_THROW(deform_positions({}, {}, 1), std::invalid_argument);
  for (const Deformation kind : all_kinds) {  // positions are finite, or refused
    try {
      const DeformOptions far{.kind = kind, .amount = 1e308, .offset = {1e308, 1e308, -1e308}};
      for (const Point3& x : deform_positions(mesh, far, 1)) {
        for (const double place : x) EXPECT_TRUE(std::isfinite(place)) << name_of(kind);
      }
    } catch (const std::invalid_argument& error) {
      EXPECT_TRUE(contains(error.what(), "amount or offset")) << name_of(kind);
    }
  }
}
}  // namespace
}  // namespace tetwarp

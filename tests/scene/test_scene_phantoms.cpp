/// @file test_scene_phantoms.cpp
/// The phantoms of an orange and a fish.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tetwarp/make.hpp>

namespace tetwarp::test {
namespace {
/// Share of the samples from a threshold on.
template <class T>
double share_from(const Volume& volume, double threshold) {
  const auto samples = volume.samples<T>();
  const auto count = std::count_if(samples.begin(), samples.end(),
                                   [&](T s) { return static_cast<double>(s) >= threshold; });
  return static_cast<double>(count) / static_cast<double>(samples.size());
}

/// Whether all samples of the outermost voxels are 0.
template <class T>
bool has_empty_margin(const Volume& volume) {
  const auto& dims = volume.grid.dims;
  const auto samples = volume.samples<T>();
  std::size_t voxel = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i, ++voxel) {
        const bool is_inside =
            i > 0 && j > 0 && k > 0 && i + 1 < dims[0] && j + 1 < dims[1] && k + 1 < dims[2];
        if (!is_inside && samples[voxel] != 0) return false;
      }
    }
  }
  return true;
}

TEST(OrangePhantom, IsAnEllipsoidThatFills95PercentOfEachAxis) {
  const Volume orange = make_orange_phantom({99, 100, 80}, {0.8e-3, 0.8e-3, 1e-3});
  EXPECT_EQ(orange.grid.spacing, (Point3{0.8e-3, 0.8e-3, 1e-3}));
  EXPECT_EQ(orange.grid.origin, (Point3{0, 0, 0}));
  const double ellipsoid = std::numbers::pi / 6 * std::pow(0.95, 3);
  EXPECT_NEAR(share_from<float>(orange, orange_phantom_threshold), ellipsoid, 2e-3 * ellipsoid);
  EXPECT_TRUE(has_empty_margin<float>(orange));
}

TEST(OrangePhantom, HasRindAndFleshOfTheStatedValues) {
  const Volume orange = make_orange_phantom({101, 101, 101}, {1, 1, 1});
  const double flesh = std::numbers::pi / 6 * std::pow(0.95, 3) * std::pow(0.85, 1.5);
  EXPECT_NEAR(share_from<float>(orange, 0.145), flesh, 5e-3 * flesh);
  // Along k, off the core and the walls: 1 - r^2.
  const auto samples = orange.samples<float>();
  for (const std::size_t k : {60, 70, 80, 90}) {
    const double x = 12 / (0.95 * 50.5);
    const double z = (static_cast<double>(k) - 50) / (0.95 * 50.5);
    EXPECT_NEAR(samples[(k * 101 + 50) * 101 + 62], 1 - x * x - z * z, 1e-6);
  }
}

TEST(OrangePhantom, HasTenSegments) {
  const Volume orange = make_orange_phantom({201, 201, 9}, {1, 1, 1});
  const auto samples = orange.samples<float>();
  int walls = 0;
  bool was_wall = false;
  for (int n = 0; n < 3600; ++n) {
    const double angle = 2 * std::numbers::pi * (n + 0.5) / 3600;
    const auto i = static_cast<std::size_t>(std::lround(100 + 65 * std::cos(angle)));
    const auto j = static_cast<std::size_t>(std::lround(100 + 65 * std::sin(angle)));
    const bool is_wall = samples[(4 * 201 + j) * 201 + i] < 0.45f;
    walls += is_wall && !was_wall;
    was_wall = is_wall;
  }
  EXPECT_EQ(walls, 10);
}

TEST(FishPhantom, IsSymmetricAndHasFinsFleshAndBones) {
  const Volume fish = make_fish_phantom({51, 50, 128}, {4e-3, 4e-3, 4e-3});
  const auto samples = fish.samples<std::uint8_t>();
  for (std::size_t row = 0; row < samples.size(); row += 51) {
    for (std::size_t i = 0; i < 25; ++i) ASSERT_EQ(samples[row + i], samples[row + 50 - i]);
  }
  for (const int level : {90, 128, 220}) {
    EXPECT_GT(std::count(samples.begin(), samples.end(), level), 20) << level;
  }
  EXPECT_EQ(*std::max_element(samples.begin(), samples.end()), 220);
  EXPECT_TRUE(has_empty_margin<std::uint8_t>(fish));
  const double share = share_from<std::uint8_t>(fish, fish_phantom_threshold);
  EXPECT_GT(share, 0.08);
  EXPECT_LT(share, 0.2);
}

TEST(Phantoms, RefuseABadGrid) {
  EXPECT_THROW(make_orange_phantom({0, 4, 4}, {1, 1, 1}), std::invalid_argument);
  EXPECT_THROW(make_fish_phantom({4, 4, 4}, {1, 0, 1}), std::invalid_argument);
}
}  // namespace
}  // namespace tetwarp::test

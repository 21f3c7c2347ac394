/// @file test_volume_sample.cpp
/// The source at a position: filters, clamping, background, rounding.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "kernels/warp/sample/volume_sample.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
/// A small volume that owns its samples.
template <class T>
struct GridSamples {
  std::array<int, 3> dims;
  int components;
  std::vector<T> data;

  SourceView<T> view() const { return {data.data(), {dims[0], dims[1], dims[2]}, components}; }
};

/// Component c of the sample at x, nothing where the background belongs.
template <class T>
std::optional<T> sample_at(const GridSamples<T>& samples,
                           Filter filter,
                           const std::array<double, 3>& x,
                           int c = 0) {
  using Real = ArithmeticOf<T>;
  int whole[3];
  Real local[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    whole[axis] = static_cast<int>(std::floor(x[axis]));
    local[axis] = static_cast<Real>(x[axis] - whole[axis]);
  }
  const Tap<Real> tap = tap_of(samples.view(), filter, whole, local);
  if (!tap.inside) return std::nullopt;
  return sample(samples.view(), filter, tap, c);
}

/// f(i, j, k) = 1 + 2 i + 4 j + 8 k - i j + k i j.
double trilinear(double i, double j, double k) {
  return 1 + 2 * i + 4 * j + 8 * k - i * j + k * i * j;
}

template <class T>
GridSamples<T> trilinear_samples(int nx, int ny, int nz) {
  GridSamples<T> samples{{nx, ny, nz}, 1, {}};
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) samples.data.push_back(static_cast<T>(trilinear(i, j, k)));
    }
  }
  return samples;
}

constexpr auto nearest = Filter::nearest;
constexpr auto linear = Filter::linear;

TEST(VolumeSample, NearestRoundsHalvesUp) {
  const GridSamples<float> row{{4, 1, 1}, 1, {10, 11, 12, 13}};

  EXPECT_EQ(sample_at(row, nearest, {-0.5, 0, 0}), 10);
  EXPECT_EQ(sample_at(row, nearest, {0.49, 0, 0}), 10);
  EXPECT_EQ(sample_at(row, nearest, {0.5, 0, 0}), 11);
  EXPECT_EQ(sample_at(row, nearest, {2.5, 0, 0}), 13);
  EXPECT_EQ(sample_at(row, nearest, {3.5, 0, 0}), 13);
}

TEST(VolumeSample, LinearBlendsItsEightNeighbors) {
  const GridSamples<float> cube{{2, 2, 2}, 1, {0, 1, 2, 3, 4, 5, 6, 7}};

  EXPECT_EQ(sample_at(cube, linear, {0.5, 0.5, 0.5}), 3.5f);
  EXPECT_EQ(sample_at(cube, linear, {0.25, 0, 1}), 4.25f);
  EXPECT_EQ(sample_at(cube, linear, {1, 0.75, 0}), 2.5f);
}

/// Dyadic positions and small integers: float64 is exact; float32 rounds three times in each of
/// seven blends of numbers below 2^15.
TEST(VolumeSample, LinearReproducesATrilinearFunction) {
  const auto single = trilinear_samples<float>(33, 32, 31);
  const auto twice = trilinear_samples<double>(33, 32, 31);
  for (std::uint64_t p = 0; p < 1025; ++p) {
    std::array<double, 3> x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      x[axis] = std::floor(30 * 16 * scenes::uniform(2, 3 * p + axis)) / 16;
    }
    const double expected = trilinear(x[0], x[1], x[2]);
    EXPECT_NEAR(sample_at(single, linear, x).value(), expected, 21 * 0x1p-24 * 0x1p15);
    EXPECT_EQ(sample_at(twice, linear, x), expected);
  }
}

TEST(VolumeSample, ClampsToTheRimAndEndsHalfAVoxelBeyond) {
  const auto volume = trilinear_samples<float>(3, 4, 5);

  EXPECT_EQ(sample_at(volume, linear, {-0.5, 1, 1}), trilinear(0, 1, 1));
  EXPECT_EQ(sample_at(volume, linear, {2.5, 3.5, 4.5}), trilinear(2, 3, 4));
  EXPECT_EQ(sample_at(volume, linear, {1, 3.25, 4}), trilinear(1, 3, 4));
  EXPECT_EQ(sample_at(volume, linear, {-0.5001, 1, 1}), std::nullopt);
  EXPECT_EQ(sample_at(volume, nearest, {1, 3.5001, 1}), std::nullopt);
  EXPECT_EQ(sample_at(volume, linear, {1, 1, 4.5001}), std::nullopt);
}

TEST(VolumeSample, TakesAPositionThatRoundingCarriedOverTheRim) {
  const auto volume = trilinear_samples<float>(3, 3, 3);

  EXPECT_EQ(sample_at(volume, linear, {-0.5 - 0x1p-20, 1, 1}), trilinear(0, 1, 1));
  EXPECT_EQ(sample_at(volume, linear, {2.5 + 0x1p-20, 1, 1}), trilinear(2, 1, 1));
}

TEST(VolumeSample, NotANumberIsOutside) {
  const auto volume = trilinear_samples<float>(3, 3, 3);
  const float x[3] = {0, std::numeric_limits<float>::quiet_NaN(), 0};
  const int whole[3] = {0, 0, 0};

  EXPECT_FALSE(tap_of(volume.view(), linear, whole, x).inside);
}

TEST(VolumeSample, ASingleVoxelIsConstant) {
  const GridSamples<float> voxel{{1, 1, 1}, 1, {7}};

  EXPECT_EQ(sample_at(voxel, linear, {-0.5, 0.5, 0.25}), 7);
  EXPECT_EQ(sample_at(voxel, nearest, {0.5, -0.5, 0}), 7);
  EXPECT_EQ(sample_at(voxel, linear, {0.6, 0, 0}), std::nullopt);
}

TEST(VolumeSample, KeepsComponentsApart) {
  const GridSamples<std::int16_t> pairs{{2, 1, 1}, 2, {10, -100, 20, -200}};

  EXPECT_EQ(sample_at(pairs, linear, {0.5, 0, 0}, 0), 15);
  EXPECT_EQ(sample_at(pairs, linear, {0.5, 0, 0}, 1), -150);
  EXPECT_EQ(sample_at(pairs, nearest, {0.75, 0, 0}, 1), -200);
}

TEST(VolumeSample, NotANumberReachesOnlyWhatBlendsIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  const GridSamples<float> row{{4, 1, 1}, 1, {1, nan, 3, infinite}};

  EXPECT_EQ(sample_at(row, linear, {0, 0, 0}), 1);
  EXPECT_TRUE(std::isnan(sample_at(row, linear, {0.25, 0, 0}).value()));
  EXPECT_TRUE(std::isnan(sample_at(row, linear, {1, 0, 0}).value()));
  EXPECT_EQ(sample_at(row, linear, {2, 0, 0}), 3);
  EXPECT_EQ(sample_at(row, linear, {2.25, 0, 0}), infinite);
  EXPECT_EQ(sample_at(row, nearest, {2.25, 0, 0}), 3);
}

TEST(VolumeSample, IntegersRoundHalfToEven) {
  EXPECT_EQ((rounded_to<std::uint8_t, float>(0.5f)), 0);
  EXPECT_EQ((rounded_to<std::uint8_t, float>(1.5f)), 2);
  EXPECT_EQ((rounded_to<std::uint8_t, float>(2.5f)), 2);
  EXPECT_EQ((rounded_to<std::int16_t, float>(-0.5f)), 0);
  EXPECT_EQ((rounded_to<std::int16_t, float>(-1.5f)), -2);
  EXPECT_EQ((rounded_to<std::int32_t, double>(-2.5)), -2);
}

TEST(VolumeSample, IntegersSaturate) {
  EXPECT_EQ((rounded_to<std::uint8_t, float>(-3.0f)), 0);
  EXPECT_EQ((rounded_to<std::uint8_t, float>(255.5f)), 255);
  EXPECT_EQ((rounded_to<std::int8_t, float>(1e20f)), 127);
  EXPECT_EQ((rounded_to<std::int32_t, double>(-1e20)), std::numeric_limits<std::int32_t>::min());
  EXPECT_EQ((rounded_to<std::uint32_t, double>(4294967295.4)), 4294967295u);
  EXPECT_EQ((rounded_to<std::int64_t, double>(0x1p63)), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ((rounded_to<std::uint64_t, double>(0x1p64)), std::numeric_limits<std::uint64_t>::max());
}

/// Whole part and rest: float32 resolves positions at voxel 2^29 as finely as at voxel 0.
TEST(VolumeSample, LosesNothingFarFromVoxelZero) {
  const double linear_part[3][3] = {{1, 0, 0}, {0, 0.5, 0}, {0, 0, 2}};
  const double near_start[3] = {0.125, 7.25, -3.375};
  const double far_start[3] = {0x1p29 + 0.125, 0x1p28 + 7.25, -0x1p29 - 3.375};

  const auto near = make_source_map<float>(near_start, linear_part);
  const auto far = make_source_map<float>(far_start, linear_part);

  float x[3], y[3];
  local_position(near, 7, 6, 5, x);
  local_position(far, 7, 6, 5, y);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(x[axis], y[axis]);
  EXPECT_EQ(far.whole[0] - near.whole[0], 1 << 29);
  EXPECT_EQ(near.whole[2], -4);
  EXPECT_EQ(x[1], 0.25f + 3.0f);
}

TEST(VolumeSample, APositionBeyondAllVolumesIsOutside) {
  const auto volume = trilinear_samples<float>(3, 3, 3);
  const double unit[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const double far : {1e18, -1e18}) {
    const double start[3] = {1, far, 1};
    const auto map = make_source_map<float>(start, unit);
    float x[3];
    local_position(map, 0, 0, 0, x);
    EXPECT_FALSE(tap_of(volume.view(), linear, map.whole, x).inside);
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_volume_filter.cpp
/// Cubic, B-spline and windowed sinc at a position, against their definitions and the reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "host/reference/warp/sample.hpp"
#include "host/warp/cpu/cell_cull_cpu.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/sample/volume_prefilter.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
constexpr std::array wide_filters = {Filter::cubic, Filter::bspline, Filter::lanczos};

/// A volume that owns its samples and, for a spline, its coefficients.
template <class T>
struct Samples {
  std::array<std::int64_t, 3> dims;
  int components = 1;
  std::vector<T> data = {};
  std::vector<ArithmeticOf<T>> coefficients = {};

  SourceView<T> view() const {
    SourceView<T> view = {
        data.data(),
        {static_cast<int>(dims[0]), static_cast<int>(dims[1]), static_cast<int>(dims[2])},
        components};
    if (!coefficients.empty()) view.coefficients = coefficients.data();
    return view;
  }
  void prefilter() {
    CpuExec exec(1);
    const auto size = static_cast<std::int64_t>(data.size());
    std::vector<double> work(data.size());
    coefficients.resize(data.size());
    const SourceView<T> source = view();
    volume_prefilter(exec, source, 0, {work.data(), size}, {coefficients.data(), size});
  }
};

/// f at every voxel.
template <class T>
Samples<T> samples_of(const std::array<std::int64_t, 3>& dims,
                      const std::function<double(double, double, double)>& f) {
  Samples<T> samples{dims};
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        samples.data.push_back(static_cast<T>(
            f(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k))));
      }
    }
  }
  samples.prefilter();
  return samples;
}

template <class T>
T sample_at(const SourceView<T>& source, Filter filter, const std::array<double, 3>& x) {
  SourcePosition<ArithmeticOf<T>> at;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    at.voxel[axis] = static_cast<int>(std::floor(x[axis]));
    at.fraction[axis] = static_cast<ArithmeticOf<T>>(x[axis] - std::floor(x[axis]));
  }
  T values[9];
  sample_wide(source, filter, at, values);
  return values[0];
}

/// Number p of a seeded set of positions from `low` to `high` on each axis; every fourth on a plane
/// of voxel centers.
std::array<double, 3> position(std::uint64_t p, double low, double high) {
  std::array<double, 3> x;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    x[axis] = low + (high - low) * scenes::uniform(91, 3 * p + axis);
    if (p % 4 == axis) x[axis] = std::nearbyint(x[axis]);
  }
  return x;
}

std::vector<double> fractions() {
  std::vector<double> all = {0, 1, 1e-30, 0x1p-24, 1 - 0x1p-24, 0.5};
  for (std::uint64_t i = 0; i < 1025; ++i) all.push_back(scenes::uniform(92, i));
  return all;
}

template <class Real>
void expect_defined_weights(double tolerance) {
  for (const Filter filter : wide_filters) {
    const int count = tap_count(filter), first = 1 - count / 2;
    for (const double fraction : fractions()) {
      const Real t = static_cast<Real>(fraction);
      Real weights[max_taps];
      filter_weights(filter, t, weights);
      double sum = 0, expected_sum = 0, expected[max_taps];
      for (int i = 0; i < count; ++i) {
        expected[i] = reference::weight_of(filter, static_cast<double>(t) - (i + first));
        expected_sum += expected[i];
        sum += weights[i];
      }
      EXPECT_NEAR(sum, 1, tolerance);
      for (int i = 0; i < count; ++i) {
        ASSERT_NEAR(weights[i], expected[i] / expected_sum, tolerance) << fraction << ' ' << i;
      }
    }
  }
}

/// The cubics of the definition cancel to within 3e-15.
TEST(VolumeFilter, WeightsAreThoseOfTheDefinitionAndSumToOne) {
  expect_defined_weights<float>(4e-7);
  expect_defined_weights<double>(4e-15);
}

TEST(VolumeFilter, InterpolatingOnesHaveOneWeightAtACenter) {
  for (const Filter filter : {Filter::cubic, Filter::lanczos}) {
    const int lower = tap_count(filter) / 2 - 1;
    float weights[max_taps];
    filter_weights(filter, 0.0f, weights);
    for (int i = 0; i < tap_count(filter); ++i) EXPECT_EQ(weights[i], i == lower ? 1 : 0);
  }
}

/// In the middle of the volume, where the rim's share of a spline is below 0.27^20.
TEST(VolumeFilter, CubicReproducesQuadraticsAndTheSplineCubics) {
  const auto scaled = [](double i) { return (i - 23.5) / 10; };
  const auto quadratic = [&](double i, double j, double k) {
    const double x = scaled(i), y = scaled(j), z = scaled(k);
    return 0.3 + x * x - 2 * x * y + 0.5 * y * y + z * (1 + x - z) + x * x * y * y * z * z;
  };
  const auto cubic = [&](double i, double j, double k) {
    const double x = scaled(i), y = scaled(j), z = scaled(k);
    return x * x * x - y * y * z + 2 * z * z * z + x * y * z - x * x * x * y * y * y;
  };
  const auto squares = samples_of<double>({48, 48, 48}, quadratic);
  const auto cubes = samples_of<double>({48, 48, 48}, cubic);
  double cubic_off = 0;
  for (std::uint64_t p = 0; p < 500; ++p) {
    const auto x = position(p, 20, 27);
    EXPECT_NEAR(sample_at(squares.view(), Filter::cubic, x), quadratic(x[0], x[1], x[2]), 1e-14);
    EXPECT_NEAR(sample_at(cubes.view(), Filter::bspline, x), cubic(x[0], x[1], x[2]), 1e-9);
    cubic_off = std::max(
        cubic_off, std::abs(sample_at(cubes.view(), Filter::cubic, x) - cubic(x[0], x[1], x[2])));
  }
  EXPECT_GT(cubic_off, 1e-5);
}

TEST(VolumeFilter, KeepsAConstantBitForBit) {
  for (const float value : {0.1f, -3.7e-5f, 1e30f, 255.0f}) {
    const auto samples =
        samples_of<float>({9, 8, 7}, [value](double, double, double) { return value; });
    for (const Filter filter : wide_filters) {
      for (std::uint64_t p = 0; p < 300; ++p) {
        const float at = sample_at(samples.view(), filter, position(p, -0.5, 6.5));
        ASSERT_EQ(at, filter == Filter::bspline ? samples.coefficients[0] : value);
      }
    }
    EXPECT_NEAR(samples.coefficients[0], value, 0x1p-23 * std::abs(value));
  }
}

TEST(VolumeFilter, GivesTheSampleItselfAtACenter) {
  const auto samples = samples_of<float>(
      {5, 4, 3}, [](double i, double j, double k) { return std::sin(7 * i + 3 * j * j - k); });
  for (const Filter filter : wide_filters) {
    std::size_t v = 0;
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 4; ++j) {
        for (int i = 0; i < 5; ++i, ++v) {
          EXPECT_EQ(
              sample_at(samples.view(), filter,
                        {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}),
              samples.data[v]);
        }
      }
    }
  }
}

/// Samples below 1; weights of three axes add up to less than 3 in size, coefficients to 27.
TEST(VolumeFilter, IsTheReferenceUpToTheRimOfVolumesOfEverySize) {
  for (const std::array<std::int64_t, 3>& dims : {std::array<std::int64_t, 3>{1, 1, 1},
                                                  {2, 1, 3},
                                                  {1, 4, 2},
                                                  {3, 3, 3},
                                                  {5, 6, 7},
                                                  {33, 8, 4}}) {
    const auto noise = [](double i, double j, double k) {
      return scenes::uniform(93, static_cast<std::uint64_t>(i + 40 * (j + 40 * k)));
    };
    const auto wide = samples_of<double>(dims, noise);
    const auto narrow = samples_of<float>(
        dims, [&](double i, double j, double k) { return static_cast<float>(noise(i, j, k)); });
    for (const Filter filter : wide_filters) {
      const WarpOptions options{.filter = filter};
      Grid grid;
      grid.dims = dims;
      const reference::Sampler<double> reference(
          {grid, PixelType::float64, 1, wide.data.data(), Memory::host}, {{0, 0, 0}, dims}, options,
          nullptr);
      for (std::uint64_t p = 0; p < 200; ++p) {
        std::array<double, 3> x = position(p, 0, 1);
        for (std::size_t axis = 0; axis < 3; ++axis) {
          x[axis] = x[axis] * static_cast<double>(dims[axis]) - 0.5;
        }
        double expected;
        reference.store({x[0], x[1], x[2]}, &expected);
        EXPECT_NEAR(sample_at(wide.view(), filter, x), expected, 1e-13);
        EXPECT_NEAR(sample_at(narrow.view(), filter, x), expected, 2e-5);
      }
    }
  }
}

TEST(VolumeFilter, MirrorsAtTheOutermostCenters) {
  const int expected[] = {2, 3, 2, 1, 0, 1, 2, 3, 2, 1};
  for (int i = -4; i < 6; ++i) EXPECT_EQ(mirrored(i, 3), expected[i + 4]);
  for (int i = -3; i < 5; ++i) EXPECT_EQ(mirrored(i, 0), 0);
}

/// Samples -1 to 2 around the position count along x, with a fraction of zero along y only one.
TEST(VolumeFilter, ANaNReachesOnlyWhatHasWeightInIt) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Filter filter : wide_filters) {
    auto samples = samples_of<float>({16, 16, 16}, [](double i, double, double) { return i; });
    samples.data[(8 * 16 + 8) * 16 + 8] = nan;
    samples.prefilter();
    const auto at = [&](double x, double y, double z) {
      return std::isnan(sample_at(samples.view(), filter, {x, y, z}));
    };
    const int reach = tap_count(filter) / 2;
    EXPECT_TRUE(at(8, 8, 8));
    EXPECT_TRUE(at(8.5, 8, 8));
    EXPECT_TRUE(at(8 - reach + 0.25, 8.25, 8.75));
    EXPECT_FALSE(at(8 - reach - 0.25, 8.25, 8.75));
    EXPECT_FALSE(at(8 + reach + 0.25, 8.25, 8.75));
    EXPECT_FALSE(at(9, 8, 8));
    EXPECT_FALSE(at(8.5, 8 + reach, 8.5));
    EXPECT_EQ(at(8.5, 9, 8.5), filter == Filter::bspline);
  }
}

TEST(VolumeFilter, OvershootsUnlessItIsClamped) {
  const auto samples =
      samples_of<float>({16, 4, 4}, [](double i, double, double) { return i < 8 ? -2 : 5; });
  for (const Filter filter : wide_filters) {
    SourceView<float> clamped = samples.view();
    const float range[] = {-2, 5};
    clamped.range = range;
    float low = 0, high = 0;
    for (double x = 0; x <= 15; x += 0.125) {
      const float free = sample_at(samples.view(), filter, {x, 1.5, 2});
      low = std::min(low, free);
      high = std::max(high, free);
      EXPECT_EQ(sample_at(clamped, filter, {x, 1.5, 2}), std::clamp(free, -2.0f, 5.0f));
    }
    EXPECT_LT(low, -2.1f);
    EXPECT_GT(high, 5.1f);
  }
}
}  // namespace
}  // namespace tetwarp::test

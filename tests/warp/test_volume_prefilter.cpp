/// @file test_volume_prefilter.cpp
/// Coefficients whose spline passes through the samples.
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host/reference/warp/sample.hpp"
#include "kernels/warp/sample/volume_prefilter.hpp"
#include "tests/support/each_exec.hpp"
#include "tests/support/scenes.hpp"

namespace tetwarp::test {
namespace {
using Dims = std::array<std::int64_t, 3>;

template <class Exec>
class VolumePrefilter : public EachExec<Exec> {
 protected:
  template <class T>
  std::vector<ArithmeticOf<T>> run(const std::vector<T>& samples,
                                   const Dims& dims,
                                   int components,
                                   double tolerance = 0) {
    const SourceView<T> source = {
        this->upload(samples).data,
        {static_cast<int>(dims[0]), static_cast<int>(dims[1]), static_cast<int>(dims[2])},
        components};
    const auto size = static_cast<std::int64_t>(samples.size());
    const auto coefficients = this->template zeros<ArithmeticOf<T>>(size);
    volume_prefilter(this->exec(), source, tolerance, this->template zeros<double>(size),
                     coefficients);
    return this->download(coefficients);
  }
};
TYPED_TEST_SUITE(VolumePrefilter, Execs, ExecNames);

template <class T>
std::vector<T> noise(const Dims& dims, int components, double scale) {
  std::vector<T> samples(static_cast<std::size_t>(dims[0] * dims[1] * dims[2] * components));
  for (std::size_t s = 0; s < samples.size(); ++s) {
    samples[s] = static_cast<T>(scale * (scenes::uniform(95, s) - 0.5));
  }
  return samples;
}

constexpr Dims tricky_dims[] = {{1, 1, 1}, {2, 1, 1}, {1, 2, 3},   {3, 2, 1},
                                {4, 5, 6}, {9, 8, 7}, {40, 3, 33}, {1, 70, 1}};

/// (c[i-1] + 4 c[i] + c[i+1]) / 6 along all three axes is the sample.
TYPED_TEST(VolumePrefilter, GivesASplineThroughTheSamples) {
  for (const Dims& n : tricky_dims) {
    const auto samples = noise<double>(n, 1, 2);
    const auto c = this->run(samples, n, 1);
    double worst = 0;
    for (std::int64_t v = 0; v < n[0] * n[1] * n[2]; ++v) {
      const std::int64_t ijk[3] = {v % n[0], v / n[0] % n[1], v / n[0] / n[1]};
      double sum = 0;
      for (int tap = 0; tap < 27; ++tap) {
        const int step[3] = {tap % 3 - 1, tap / 3 % 3 - 1, tap / 9 - 1};
        double weight = 1;
        std::int64_t at = 0;
        for (std::size_t axis = 3; axis-- > 0;) {
          weight *= step[axis] == 0 ? 4.0 / 6 : 1.0 / 6;
          at = at * n[axis] + reference::stand_in(Filter::bspline, ijk[axis] + step[axis], n[axis]);
        }
        sum += weight * c[static_cast<std::size_t>(at)];
      }
      worst = std::max(worst, std::abs(sum - samples[static_cast<std::size_t>(v)]));
    }
    EXPECT_LE(worst, 1e-14) << n[0] << ' ' << n[1] << ' ' << n[2];
  }
}

/// Coefficients are below 27 times the samples.
TYPED_TEST(VolumePrefilter, IsTheReferenceForEveryArithmetic) {
  const auto expect_near = [&]<class T>(T, double scale, double tolerance) {
    for (const Dims& dims : tricky_dims) {
      for (const int components : {1, 3}) {
        const auto samples = noise<T>(dims, components, scale);
        const auto expected =
            reference::spline_coefficients({samples.begin(), samples.end()}, dims, components);
        const auto found = this->run(samples, dims, components);
        for (std::size_t s = 0; s < expected.size(); ++s) {
          ASSERT_NEAR(found[s], expected[s], 27 * scale * tolerance) << s;
        }
      }
    }
  };
  expect_near(std::int16_t{}, 20000, 0x1p-24);
  expect_near(float{}, 2, 0x1p-24);
  expect_near(double{}, 2, 1e-15);
  expect_near(std::int32_t{}, 1e9, 1e-15);
}

/// A step from 1 to 0, whose ringing falls below 1e-6 within eleven voxels.
TYPED_TEST(VolumePrefilter, SettlesWhereTheSamplesAreEven) {
  const Dims dims = {64, 3, 2};
  std::vector<double> samples(64 * 3 * 2);
  for (std::size_t s = 0; s < samples.size(); ++s) samples[s] = s % 64 < 20 ? 1 : 0;

  const auto free = this->run(samples, dims, 1), even = this->run(samples, dims, 1, 1e-6);

  for (std::size_t s = 0; s < samples.size(); ++s) {
    const std::size_t i = s % 64;
    if (i < 9 || i > 30) {
      EXPECT_EQ(even[s], samples[s]) << s;
    } else if (i > 10 && i < 29) {
      EXPECT_EQ(even[s], free[s]) << s;
      EXPECT_NE(free[s], samples[s]) << s;
    }
  }
}

TYPED_TEST(VolumePrefilter, BridgesGapsAndKeepsThem) {
  using Limits = std::numeric_limits<float>;
  const Dims dims = {12, 5, 4};
  auto samples = noise<float>(dims, 1, 2);
  for (const std::size_t s : {0, 1, 17, 18, 119}) samples[s] = Limits::quiet_NaN();
  for (std::size_t s = 48; s < 60; ++s) samples[s] = Limits::infinity();
  const auto expected = reference::spline_coefficients({samples.begin(), samples.end()}, dims, 1);

  const auto found = this->run(samples, dims, 1);

  for (std::size_t s = 0; s < samples.size(); ++s) {
    if (std::isnan(samples[s])) {
      EXPECT_TRUE(std::isnan(found[s])) << s;
    } else if (std::isinf(samples[s])) {
      EXPECT_EQ(found[s], samples[s]) << s;
    } else {
      EXPECT_NEAR(found[s], expected[s], 27 * 2 * 0x1p-24) << s;
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

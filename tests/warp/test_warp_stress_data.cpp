/// @file test_warp_stress_data.cpp
/// Difficult samples: NaN, infinities, denormals and the ends of every range affect only the voxels
/// that read them. Numbers behind "found" are the largest seen on cpu.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "tests/support/each_backend.hpp"
#include "tests/support/position_probe.hpp"
#include "tests/support/solid_scenes.hpp"

namespace tetwarp::test {
namespace {
class WarpStressData : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Backends, WarpStressData, each_backend, name_of_backend);

constexpr std::int64_t edge = 30;       ///< voxels per axis, of source and output
constexpr std::uint64_t seed = 0x5eed;  ///< of all samples

/// Maps of about one, in float32; maps that stretch sevenfold, in float64; maps of powers of two,
/// which put every position exactly on a voxel or in the middle between two.
std::vector<scenes::Scene> data_scenes() {
  const Grid grid = scenes::unit_grid(edge, edge, edge);
  scenes::Scene turned = turned_solid(grid, grid, {3, 4, 3}).scene;
  scenes::Scene squeezed = turned;
  squeezed.name = "squeezed";
  for (Point3& p : squeezed.deformed) p[0] = 14.5 + (p[0] - 14.5) / 7;
  scenes::Scene dyadic = {
      "dyadic", scenes::lattice({1, 1, 1}, {1, 1, 1}, {17, 17, 17}), {}, grid, grid};
  for (const Point3& p : dyadic.mesh.rest_positions) {
    dyadic.deformed.push_back({2 * p[0] - 1, p[1] + p[2] - 8, p[2]});
  }
  return {turned, squeezed, dyadic};
}

/// How far a position may be off [voxel]: see test_warp_error.cpp.
long double slack_of(const scenes::Scene& scene) {
  return scene.name == "dyadic" ? 0 : 1e-5L;
}

/// Calls f(first sample of an output voxel, its exact source position) for owned voxels.
template <class F>
void for_each_position(const scenes::Scene& scene, const Warped& warped, F f) {
  const Grid& grid = scene.output_grid;
  const auto deformed = tets_of(grid, scene.mesh, scene.deformed);
  const auto rest = tets_of(scene.source_grid, scene.mesh, scene.mesh.rest_positions);
  std::int64_t visited = 0;
  for (std::int64_t voxel = 0; voxel < grid.voxel_count(); ++voxel) {
    const std::int32_t owner = warped.owner[static_cast<std::size_t>(voxel)];
    if (owner < 0) continue;
    const auto t = static_cast<std::size_t>(owner);
    const std::array ijk = {voxel % edge, voxel / edge % edge, voxel / edge / edge};
    f(static_cast<std::size_t>(voxel * warped.volume.components),
      rounded_position(deformed[t], rest[t], ijk));
    ++visited;
  }
  EXPECT_GT(visited, 1000);
}

/// True when a voxel less than `reach` from x along every axis is marked.
bool has_marked(const std::vector<bool>& marked, const Real3& x, long double reach) {
  std::array<std::int64_t, 3> first, last;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto below = static_cast<std::int64_t>(std::floor(x[axis] - reach));
    const auto above = static_cast<std::int64_t>(std::ceil(x[axis] + reach));
    first[axis] = std::max(std::int64_t{0}, below + 1);
    last[axis] = std::min(edge - 1, above - 1);
  }
  for (std::int64_t k = first[2]; k <= last[2]; ++k) {
    for (std::int64_t j = first[1]; j <= last[1]; ++j) {
      for (std::int64_t i = first[0]; i <= last[0]; ++i) {
        if (marked[static_cast<std::size_t>((k * edge + j) * edge + i)]) return true;
      }
    }
  }
  return false;
}

/// Interpolation of the samples around a position.
struct Blend {
  long double value = 0;
  long double low = INFINITY, high = -INFINITY;  ///< of the eight
};
template <class T>
Blend blend_at(std::span<const T> samples, const Real3& x) {
  Blend blend;
  for (int corner = 0; corner < 8; ++corner) {
    std::int64_t at = 0;
    long double weight = 1;
    for (std::size_t axis = 3; axis-- > 0;) {
      const long double lower = std::floor(x[axis]);
      const int up = corner >> axis & 1;
      weight *= up != 0 ? x[axis] - lower : 1 - (x[axis] - lower);
      at = at * edge + std::min(static_cast<std::int64_t>(lower) + up, edge - 1);
    }
    const auto sample = static_cast<long double>(samples[static_cast<std::size_t>(at)]);
    blend.value += weight * sample;
    blend.low = std::min(blend.low, sample);
    blend.high = std::max(blend.high, sample);
  }
  return blend;
}

/// One sample in 30 is NaN or infinite. An output is finite unless one of them is less than a voxel
/// from its position along every axis, and then it is not; 1e-5 voxel is left to rounding, none
/// where positions are exact.
TEST_P(WarpStressData, NanAndInfinityReachExactlyWhatBlendsThem) {
  for (const scenes::Scene& scene : data_scenes()) {
    for (const PixelType type : {PixelType::float32, PixelType::float64}) {
      for (const int components : {1, 2}) {
        SCOPED_TRACE(scene.name + name_of(type) + std::to_string(components));
        Volume source = scenes::wavy_volume(scene.source_grid, type, components);
        std::vector<bool> odd(edge * edge * edge);
        with_pixel_type(type, [&]<class T>(T) {
          for (std::size_t v = 0; v < odd.size(); ++v) {
            const double draw = 90 * scenes::uniform(seed, v);
            odd[v] = draw < 3;
            T& sample = source.samples<T>()[v * static_cast<std::size_t>(components)];
            if (draw < 1) sample = std::numeric_limits<T>::quiet_NaN();
            if (draw >= 1 && draw < 2) sample = std::numeric_limits<T>::infinity();
            if (draw >= 2 && draw < 3) sample = -std::numeric_limits<T>::infinity();
          }
        });

        const Warped warped = run_warp(source, scene, GetParam());

        const std::vector<double> samples = numbers_of(warped.volume);
        for_each_position(scene, warped, [&](std::size_t s, const Real3& x) {
          const bool is_odd = !std::isfinite(samples[s]);
          EXPECT_TRUE(!is_odd || has_marked(odd, x, 1 + slack_of(scene))) << s;
          EXPECT_TRUE(is_odd || !has_marked(odd, x, 1 - slack_of(scene))) << s;
          for (int c = 1; c < components; ++c) EXPECT_TRUE(std::isfinite(samples[s + 1]));
        });
      }
    }
  }
}

/// Of any bit pattern, signaling NaNs and denormals among them, every bit is kept.
TEST_P(WarpStressData, NearestCopiesBits) {
  WarpOptions options;
  options.filter = Filter::nearest;
  for (const scenes::Scene& scene : data_scenes()) {
    for (const PixelType type : {PixelType::float32, PixelType::float64, PixelType::int64}) {
      SCOPED_TRACE(scene.name + name_of(type));
      Volume source = make_volume(scene.source_grid, type);
      for (std::size_t b = 0; b < source.data.size(); ++b) {
        source.data[b] = static_cast<std::byte>(256 * scenes::uniform(seed, b));
      }

      const Warped warped = run_warp(source, scene, GetParam(), options);

      const std::size_t size = size_of(type);
      for_each_position(scene, warped, [&](std::size_t s, const Real3& x) {
        std::int64_t at = 0;
        for (std::size_t axis = 3; axis-- > 0;) {
          const long double middle = x[axis] + 0.5L;
          if (std::abs(middle - std::round(middle)) < slack_of(scene))
            return;  // either side will do
          at = at * edge + static_cast<std::int64_t>(std::floor(middle));
        }
        EXPECT_EQ(std::memcmp(&warped.volume.data[s * size],
                              &source.data[static_cast<std::size_t>(at) * size], size),
                  0);
      });
    }
  }
}

/// Samples of 0 to 1000 times the smallest number, whose bits are that number of times. Sums of
/// them are exact and each of at most eight products rounds by half that unit; none is flushed to
/// zero. Found: 1.3 units.
TEST_P(WarpStressData, DenormalsInterpolateToTheirLastBit) {
  double worst = 0;
  for (const scenes::Scene& scene : data_scenes()) {
    for (const PixelType type : {PixelType::float32, PixelType::float64}) {
      Volume source = make_volume(scene.source_grid, type);
      std::vector<double> units(edge * edge * edge);
      const std::size_t size = size_of(type);
      for (std::size_t v = 0; v < units.size(); ++v) {
        const auto bits = static_cast<std::uint64_t>(1000 * scenes::uniform(seed, v));
        units[v] = static_cast<double>(bits);
        std::memcpy(&source.data[v * size], &bits, size);  // low bytes first
      }

      const Warped warped = run_warp(source, scene, GetParam());

      for_each_position(scene, warped, [&](std::size_t s, const Real3& x) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &warped.volume.data[s * size], size);
        const Blend blend = blend_at(std::span<const double>(units), x);
        const long double error = std::abs(static_cast<long double>(bits) - blend.value);
        EXPECT_LE(error, 4 + 3 * slack_of(scene) * 1000);
        worst = std::max(worst, static_cast<double>(error));
      });
    }
  }
  found("units", worst);
}

/// Samples of both signs just below half the largest number, so that differences are finite, and of
/// one sign just below the largest: finite, and between their neighbors but for rounding.
TEST_P(WarpStressData, HugeSamplesStayFiniteAndBetweenTheirNeighbors) {
  for (const scenes::Scene& scene : data_scenes()) {
    for (const PixelType type : {PixelType::float32, PixelType::float64}) {
      for (const bool both_signs : {true, false}) {
        Volume source = make_volume(scene.source_grid, type);
        with_pixel_type(type, [&]<class T>(T) {
          const T largest = T(0.999) * std::numeric_limits<T>::max();
          for (std::size_t v = 0; v < source.samples<T>().size(); ++v) {
            const T draw = scenes::uniform(seed, v) < 0.5 ? T(0) : T(1);
            source.samples<T>()[v] = both_signs ? largest * (draw - T(0.5)) : largest * draw;
          }

          const Warped warped = run_warp(source, scene, GetParam());

          const Volume& constant = source;
          const auto rounding = 4 * static_cast<long double>(largest) *
                                static_cast<long double>(std::numeric_limits<T>::epsilon());
          for_each_position(scene, warped, [&](std::size_t s, const Real3& x) {
            const Blend blend = blend_at(constant.samples<T>(), x);
            const auto value = static_cast<long double>(warped.volume.samples<T>()[s]);
            EXPECT_GE(value, blend.low - rounding);
            EXPECT_LE(value, blend.high + rounding);
          });
        });
      }
    }
  }
}

/// Neighbors at opposite ends of an integer's range: the nearest integer, but for the position and
/// 21 roundings of float32. Found, of 65,535: the half exceeded by 0.05.
TEST_P(WarpStressData, IntegersAtTheEndsOfTheirRangeAreTheNearest) {
  double worst = 0;
  for (const scenes::Scene& scene : data_scenes()) {
    for (const PixelType type : {PixelType::uint8, PixelType::int8, PixelType::uint16,
                                 PixelType::int16, PixelType::uint32, PixelType::int32}) {
      SCOPED_TRACE(scene.name + name_of(type));
      Volume source = make_volume(scene.source_grid, type);
      with_pixel_type(type, [&]<class T>(T) {
        using Limits = std::numeric_limits<T>;
        for (std::size_t v = 0; v < source.samples<T>().size(); ++v) {
          source.samples<T>()[v] = scenes::uniform(seed, v) < 0.5 ? Limits::min() : Limits::max();
        }

        const Warped warped = run_warp(source, scene, GetParam());

        const Volume& constant = source;
        const long double range = static_cast<long double>(Limits::max()) - Limits::min();
        const long double arithmetic =
            sizeof(T) == 4 ? 1e-12L : 3 * slack_of(scene) + 21 * 0x1p-24L;  // of the range
        for_each_position(scene, warped, [&](std::size_t s, const Real3& x) {
          const auto value = static_cast<long double>(warped.volume.samples<T>()[s]);
          const long double error =
              std::abs(value - blend_at(constant.samples<T>(), x).value) - 0.5L;
          EXPECT_LE(error, arithmetic * range);
          if (sizeof(T) == 2) worst = std::max(worst, static_cast<double>(error));
        });
      });
    }
  }
  found("over_half", worst);
}

/// A background of NaN is stored in uncovered voxels only.
TEST_P(WarpStressData, AnOddBackgroundStaysOutside) {
  for (const double background : {std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::infinity(), 5e-324}) {
    for (const scenes::Scene& scene : data_scenes()) {
      Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float64);
      for (double& sample : source.samples<double>()) sample += 1;
      WarpOptions options;
      options.background = background;

      const Warped warped = run_warp(source, scene, GetParam(), options);

      for (std::size_t v = 0; v < warped.owner.size(); ++v) {
        const double value = warped.volume.samples<double>()[v];
        const bool is_background = std::isnan(background) ? std::isnan(value) : value == background;
        ASSERT_EQ(is_background, warped.owner[v] < 0) << v;
      }
      EXPECT_GT(warped.counts.outside, 1000);
    }
  }
}
}  // namespace
}  // namespace tetwarp::test

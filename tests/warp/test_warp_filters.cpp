/// @file test_warp_filters.cpp
/// Whole warps by the filters wider than linear and by labels, on every back end.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/each_backend.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class WarpFilters : public EachBackend {
 protected:
  Warped run(const Volume& source, const scenes::Scene& scene, const WarpOptions& options) {
    return run_warp(source, scene, GetParam(), options);
  }
};
INSTANTIATE_TEST_SUITE_P(Backends, WarpFilters, each_backend, name_of_backend);

constexpr std::array smooth_filters = {Filter::cubic, Filter::bspline, Filter::lanczos};

/// Positions are good to 2e-6 voxel; samples below 1, neighbors differing by less than 1/8 per
/// axis, make slopes of at most six times that. Weights and sums of float32 cost less than 60 ulp.
/// Found: 3.6e-7.
TEST_P(WarpFilters, AreTheReference) {
  if (GetParam() == Backend::reference) GTEST_SKIP() << "the reference is not compared with itself";
  double worst = 0;
  for (const char* name : {"half_voxel", "waved", "oblique", "slivers_1", "soup", "other_grid"}) {
    const scenes::Scene scene = scenes::adversarial_scene(name, 18);
    const Volume narrow = scenes::wavy_volume(scene.source_grid, PixelType::float32, 2);
    const Volume wide = scenes::wavy_volume(scene.source_grid, PixelType::float64);
    for (const Filter filter : smooth_filters) {
      const WarpOptions options{.filter = filter, .outside = Outside::identity, .background = -3};
      const auto error_of = [&](const Volume& source) {
        return largest_difference(run(source, scene, options).volume,
                                  run_warp(source, scene, Backend::reference, options).volume);
      };
      worst = std::max(worst, error_of(narrow));
      EXPECT_LE(error_of(narrow), 1e-5) << name << ' ' << static_cast<int>(filter);
      EXPECT_LE(error_of(wide), 1e-12) << name << ' ' << static_cast<int>(filter);
    }
  }
  found("worst", worst);
}

TEST_P(WarpFilters, RoundIntegersToTheNearestAndSaturate) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 18);
  for (const Filter filter : smooth_filters) {
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::uint32}) {
      Volume source = make_volume(scene.source_grid, type);
      with_pixel_type(type, [&]<class T>(T) {
        for (std::size_t s = 0; s < source.samples<T>().size(); ++s) {
          const bool is_high = scenes::uniform(97, s / 3) < 0.5;
          source.samples<T>()[s] = is_high ? std::numeric_limits<T>::max() : T{};
        }
      });
      Volume wide = make_volume(source.grid, PixelType::float64);
      std::ranges::copy(numbers_of(source), wide.samples<double>().begin());
      const double scale = *std::ranges::max_element(wide.samples<double>());

      const auto rounded = numbers_of(run(source, scene, {.filter = filter}).volume);
      const auto real = numbers_of(run_warp(wide, scene, Backend::reference,
                                            {.filter = filter, .overshoot = Overshoot::keep})
                                       .volume);

      double low = 0;
      with_pixel_type(type, [&]<class T>(T) { low = double(std::numeric_limits<T>::min()); });
      std::int64_t saturated = 0;
      for (std::size_t s = 0; s < real.size(); ++s) {
        const double expected = std::clamp(real[s], low, scale);
        saturated += expected != real[s];
        ASSERT_NEAR(rounded[s], expected, 0.5 + 2e-5 * scale * (type != PixelType::uint32));
      }
      EXPECT_GT(saturated, 100);
    }
  }
}

/// Whole voxels are copied; without that switch every filter has to give the sample itself.
TEST_P(WarpFilters, ReturnTheSourceUnderAWholeShift) {
  const Grid grid = scenes::oblique_grid(14, 12, 13);
  for (const Filter filter : {Filter::cubic, Filter::bspline, Filter::lanczos, Filter::labels}) {
    for (const PixelType type : {PixelType::float32, PixelType::int16, PixelType::float64}) {
      if (filter == Filter::labels && !is_integer(type)) continue;
      const Volume source = scenes::wavy_volume(grid, type);
      const Mesh mesh = covering_mesh(grid);
      scenes::Scene scene = {"shift", mesh, moved(grid, mesh.rest_positions, {2, -1, 3}), grid,
                             grid};
      WarpOptions options{.filter = filter};
      const Warped copied = run(source, scene, options);
      options.expert.skip.copied_voxels = false;
      const Warped sampled = run(source, scene, options);
      options.filter = Filter::nearest;

      EXPECT_EQ(sampled.volume.data, copied.volume.data);
      EXPECT_EQ(run(source, scene, options).volume.data, copied.volume.data);
      EXPECT_GT(sampled.counts.covered, 500);
    }
  }
}

TEST_P(WarpFilters, ClampOvershootToEachComponentsRange) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 18);
  Volume source = make_volume(scene.source_grid, PixelType::float32, 2);
  for (std::size_t s = 0; s < source.samples<float>().size(); ++s) {
    const bool is_high = scenes::uniform(96, s / 2) < 0.5;
    source.samples<float>()[s] = s % 2 == 0 ? (is_high ? 5.0f : 3.0f) : (is_high ? 200.0f : 100.0f);
  }
  for (const Filter filter : smooth_filters) {
    const Warped free = run(source, scene, {.filter = filter, .background = 4});
    const Warped clamped =
        run(source, scene, {.filter = filter, .overshoot = Overshoot::clamp, .background = 4});
    std::int64_t beyond = 0;
    for (std::size_t s = 0; s < free.volume.samples<float>().size(); ++s) {
      if (free.owner[s / 2] < 0) continue;
      const float value = free.volume.samples<float>()[s];
      const float expected =
          s % 2 == 0 ? std::clamp(value, 3.0f, 5.0f) : std::clamp(value, 100.0f, 200.0f);
      beyond += value != expected;
      ASSERT_EQ(clamped.volume.samples<float>()[s], expected);
    }
    EXPECT_GT(beyond, 1000);
  }
}

/// A NaN and an infinity, seen by a sixth of the voxels at most: the same ones as in the reference.
TEST_P(WarpFilters, KeepWhatIsNotANumberWhereItBelongs) {
  scenes::Scene scene = scenes::adversarial_scene("waved", 18);
  Volume source = scenes::wavy_volume(scene.source_grid, PixelType::float32);
  const auto samples = source.samples<float>();
  samples[samples.size() / 2 + 12] = std::numeric_limits<float>::quiet_NaN();
  samples[samples.size() / 3] = std::numeric_limits<float>::infinity();
  for (const Filter filter : smooth_filters) {
    for (const Overshoot overshoot : {Overshoot::keep, Overshoot::clamp}) {
      const WarpOptions options{.filter = filter, .overshoot = overshoot};
      const auto values = numbers_of(run(source, scene, options).volume);
      const auto expected = numbers_of(run_warp(source, scene, Backend::reference, options).volume);
      std::size_t odd = 0;
      for (std::size_t v = 0; v < values.size(); ++v) {
        odd += !std::isfinite(values[v]);
        ASSERT_EQ(std::isfinite(values[v]), std::isfinite(expected[v])) << v;
      }
      EXPECT_GT(odd, 20u);
      EXPECT_LT(odd, values.size() / 6);
    }
  }
}

/// Eleven labels in blobs on a turned grid, and one volume per label for the reference to
/// interpolate linearly. Where the weights of two labels differ by less than 1e-5 either is
/// accepted.
TEST_P(WarpFilters, LabelsAreTheLargestOfInterpolatedIndicators) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 32);
  Volume source = make_volume(scene.source_grid, PixelType::uint16);
  const auto labels = source.samples<std::uint16_t>();
  const auto& n = scene.source_grid.dims;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = static_cast<std::int64_t>(v);
    const std::int64_t block =
        at % n[0] / 3 + 7 * (at / n[0] % n[1] / 4) + 5 * (at / n[0] / n[1] / 3);
    labels[v] = static_cast<std::uint16_t>(100 + 50 * (block % 11));
  }
  std::vector<double> best(static_cast<std::size_t>(scene.output_grid.voxel_count()), -1);
  std::vector<double> second = best, expected(best.size(), 0);
  for (int label = 0; label < 11; ++label) {
    Volume indicator = make_volume(scene.source_grid, PixelType::float64);
    for (std::size_t v = 0; v < labels.size(); ++v) {
      indicator.samples<double>()[v] = labels[v] == 100 + 50 * label;
    }
    const auto share = numbers_of(run_warp(indicator, scene, Backend::reference).volume);
    for (std::size_t v = 0; v < share.size(); ++v) {
      if (share[v] > best[v]) expected[v] = 100 + 50 * label;
      second[v] = std::max(second[v], std::min(share[v], best[v]));
      best[v] = std::max(best[v], share[v]);
    }
  }

  const Warped warped = run(source, scene, {.filter = Filter::labels});

  std::int64_t close = 0;
  for (std::size_t v = 0; v < expected.size(); ++v) {
    if (warped.owner[v] < 0) continue;
    const bool is_close = best[v] - second[v] < 1e-5;
    close += is_close;
    ASSERT_TRUE(is_close || warped.volume.samples<std::uint16_t>()[v] == expected[v]) << v;
  }
  EXPECT_LT(close, 20);
  EXPECT_GT(warped.counts.covered, 20000);
}

/// A middle plane halfway between voxels: each one there is a tie.
TEST_P(WarpFilters, LabelTiesGoToTheLowest) {
  const Grid grid = scenes::unit_grid(16, 12, 12);
  Volume source = make_volume(grid, PixelType::int64);
  for (std::size_t v = 0; v < source.samples<std::int64_t>().size(); ++v) {
    source.samples<std::int64_t>()[v] = v % 16 < 8 ? 7 : -(std::int64_t{1} << 60);
  }
  const Mesh mesh = covering_mesh(grid);
  const scenes::Scene scene = {"half", mesh, moved(grid, mesh.rest_positions, {0.5, 0.25, 0}), grid,
                               grid};

  const Warped warped = run(source, scene, {.filter = Filter::labels});

  for (std::size_t v = 0; v < warped.owner.size(); ++v) {
    if (warped.owner[v] < 0) continue;
    const std::int64_t expected = v % 16 < 8 ? 7 : -(std::int64_t{1} << 60);
    ASSERT_EQ(warped.volume.samples<std::int64_t>()[v], expected) << v;
  }
}
}  // namespace
}  // namespace tetwarp::test

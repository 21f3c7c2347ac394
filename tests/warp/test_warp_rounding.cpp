/// @file test_warp_rounding.cpp
/// Conservative intensities stored as integers: rounded without bias, by the index in the output.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "kernels/base/stochastic_rounding.hpp"
#include "tests/support/affine_scenes.hpp"
#include "tests/support/intensity_run.hpp"
#include "tests/support/skip_series.hpp"

namespace tetwarp::test {
namespace {
/// A turned and waved mesh in an output that holds all of it.
scenes::Scene turned_scene(double scale) {
  const Grid source = scenes::unit_grid(10, 9, 9);
  Grid output = scenes::unit_grid(22, 20, 21);
  output.origin = {-6, -6, -6};
  scenes::Scene scene = affine_scene(source, output, turn(0.5, {1, 2, -1}) * scale);
  scene.deformed = scenes::waved(scene.deformed, 1.0, 17);
  return scene;
}

/// A small value in half of the voxels, up to 85 in the others.
Volume speckled(const Grid& grid, PixelType type, int components = 1) {
  const Volume waves = scenes::wavy_volume(grid, PixelType::uint8, components);
  Volume volume = make_volume(grid, type, components);
  with_pixel_type(type, [&]<class T>(T) {
    const auto samples = volume.samples<T>();
    for (std::size_t n = 0; n < samples.size(); ++n) {
      const int third = waves.samples<std::uint8_t>()[n] / 3;
      samples[n] = static_cast<T>(n % 2 == 0 ? 3 : third);
    }
  });
  return volume;
}

Step conserved(const Volume& source,
               const scenes::Scene& scene,
               Backend backend,
               const WarpOptions& options = {}) {
  return run(source, scene, backend, Intensity::conservative, options);
}

double sum_of(const std::vector<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

TEST(StochasticRounding, IsUnbiasedAndKeepsWholeNumbers) {
  for (const double value : {0.0, 7.0, -3.0, 0x1p40}) {
    EXPECT_EQ(stochastically_rounded(value, 12345), value);
  }
  constexpr int count = 200000;
  for (const double value : {0.01, 0.25, 0.5, 0.97, -0.3, -17.9, 254.6}) {
    double sum = 0;
    for (int n = 0; n < count; ++n) {
      const double whole = stochastically_rounded(value, static_cast<std::uint64_t>(n));
      ASSERT_LT(std::abs(whole - value), 1);
      sum += whole - value;
    }
    EXPECT_LE(std::abs(sum), 5 * 0.5 * std::sqrt(count)) << value;
  }
}

/// Errors of neighbors are independent: their products sum to zero within five deviations.
TEST(StochasticRounding, DoesNotRelateNeighbors) {
  constexpr int count = 200000;
  for (const int apart : {1, 2, 3, 64, 4096}) {
    double sum = 0;
    for (int n = 0; n < count; ++n) {
      const auto at = static_cast<std::uint64_t>(n);
      sum += (stochastically_rounded(0.5, at) - 0.5) *
             (stochastically_rounded(0.5, at + static_cast<std::uint64_t>(apart)) - 0.5);
    }
    EXPECT_LE(std::abs(sum), 5 * 0.25 * std::sqrt(count)) << apart;
  }
}

TEST(WarpRounding, KeepsTheTotalOfIntegersWithinFiveDeviations) {
  const scenes::Scene scene = turned_scene(1.1);
  const Volume wide = speckled(scene.source_grid, PixelType::float64);
  std::map<PixelType, std::vector<std::byte>> first;
  for (const Backend backend : usable_backends()) {
    const auto exact = numbers_of(conserved(wide, scene, backend).volume);
    for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::uint32}) {
      SCOPED_TRACE(std::string(name_of(type)) + " " + name_of(backend));
      const Volume source = speckled(scene.source_grid, type);
      const Step result = conserved(source, scene, backend);
      const auto stored = numbers_of(result.volume);
      std::int64_t fractional = 0;
      for (std::size_t n = 0; n < exact.size(); ++n) {
        ASSERT_LT(std::abs(stored[n] - exact[n]), 1);
        fractional += exact[n] != std::floor(exact[n]);
      }
      EXPECT_GT(fractional, 800);
      const Totals& totals = result.report.totals;
      const double bound = 5 * 0.5 * std::sqrt(static_cast<double>(fractional));
      EXPECT_LE(std::abs(totals.after[0] - totals.before[0]), bound);
      EXPECT_NEAR(totals.rounding[0], sum_of(stored) - sum_of(exact), 1e-4);
      EXPECT_EQ(totals.clipping[0], 0);
      EXPECT_EQ(result.report.counts.values_clipped, 0);
      EXPECT_NEAR(totals.relative_change(0), totals.rounding[0] / totals.before[0], 1e-12);
      const auto& expected = first.try_emplace(type, result.volume.data).first->second;
      EXPECT_EQ(result.volume.data, expected);
    }
  }
}

/// Values below one half became zero when they were rounded to the nearest integer.
TEST(WarpRounding, KeepsSmallValues) {
  const scenes::Scene scene = turned_scene(1.5);
  Volume source = make_volume(scene.source_grid, PixelType::uint8);
  std::ranges::fill(source.samples<std::uint8_t>(), std::uint8_t{1});
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Totals totals = conserved(source, scene, backend).report.totals;
    EXPECT_GT(totals.before[0], 800);
    EXPECT_NEAR(totals.after[0] / totals.before[0], 1, 0.1);
  }
}

TEST(WarpRounding, CountsWhatTheTypeCannotHold) {
  const scenes::Scene scene = turned_scene(0.8);
  Volume source = make_volume(scene.source_grid, PixelType::uint8);
  std::ranges::fill(source.samples<std::uint8_t>(), std::uint8_t{200});
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Step result = conserved(source, scene, backend);
    const auto stored = numbers_of(result.volume);
    const Totals& totals = result.report.totals;
    EXPECT_GT(result.report.counts.values_clipped, 100);
    EXPECT_LE(result.report.counts.values_clipped, std::ranges::count(stored, 255.0));
    EXPECT_LT(totals.clipping[0], -1000);
    const double unchanged = totals.after[0] - totals.rounding[0] - totals.clipping[0];
    EXPECT_NEAR(unchanged / totals.before[0], 1, 1e-9);
    const double change = totals.rounding[0] + totals.clipping[0];
    EXPECT_NEAR(totals.relative_change(0), change / totals.before[0], 1e-9);
  }
}

TEST(WarpRounding, ReportsNoChangeOfFloatingPoint) {
  const scenes::Scene scene = turned_scene(1);
  const Volume source = speckled(scene.source_grid, PixelType::float32, 2);
  for (const Backend backend : usable_backends()) {
    const Totals totals = conserved(source, scene, backend).report.totals;
    EXPECT_EQ(totals.rounding, std::vector<double>(2, 0.0));
    EXPECT_EQ(totals.clipping, std::vector<double>(2, 0.0));
    EXPECT_EQ(totals.relative_change(0), 0);
  }
}

/// A region, any number of threads and every back end have the numbers of the whole output.
TEST(WarpRounding, DependsOnTheIndexInTheOutputAlone) {
  const scenes::Scene scene = turned_scene(1);
  const Volume source = speckled(scene.source_grid, PixelType::uint8, 2);
  const Region region = {{5, 3, 7}, {18, 12, 13}};
  for (const Backend backend : usable_backends()) {
    SCOPED_TRACE(name_of(backend));
    const Volume whole = conserved(source, scene, backend, {.threads = 3}).volume;
    const Volume part = conserved(source, scene, backend, {.region = region, .threads = 1}).volume;
    const auto all = whole.samples<std::uint8_t>(), some = part.samples<std::uint8_t>();
    std::size_t n = 0;
    for (std::int64_t k = region.begin[2]; k < region.end[2]; ++k) {
      for (std::int64_t j = region.begin[1]; j < region.end[1]; ++j) {
        const auto row = static_cast<std::size_t>(2 * ((k * 20 + j) * 22 + region.begin[0]));
        for (std::size_t i = 0; i < 2 * 13; ++i) ASSERT_EQ(some[n++], all[row + i]);
      }
    }
    EXPECT_EQ(n, some.size());
    EXPECT_GT(std::ranges::count_if(some, [](std::uint8_t sample) { return sample > 0; }), 100);
  }
}

/// Steps that write only a part of the output report the changes of all of it.
TEST(WarpRounding, UpdatesReportTheWholeChange) {
  const scenes::Scene scene = turned_scene(0.8);
  const std::vector<Volume> sources = {scenes::wavy_volume(scene.source_grid, PixelType::uint8, 2)};
  for (const Backend backend : usable_backends()) {
    if (backend == Backend::reference) continue;  // leaves nothing out
    SCOPED_TRACE(name_of(backend));
    WarpOptions options{.intensity = Intensity::conservative, .backend = backend, .threads = 2};
    Series updated(sources, scene, options);
    options.expert.skip = {false, false, false, false, false, false, false};
    Series anew(sources, scene, options);
    std::int64_t unchanged = 0;
    for (const auto& positions : partial_motions(scene, 31)) {
      const Counts counts = updated.step(positions);
      unchanged += counts.cells_unchanged;
      EXPECT_EQ(counts.values_clipped, anew.step(positions).values_clipped);
      EXPECT_EQ(updated.totals().rounding, anew.totals().rounding);
      EXPECT_EQ(updated.totals().clipping, anew.totals().clipping);
    }
    EXPECT_GT(unchanged, 0);
  }
}
}  // namespace
}  // namespace tetwarp::test

/// @file test_warp_values.cpp
/// Values against the reference: bounds that follow from the arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/each_scene.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class WarpValues : public EachScene<32> {};
INSTANTIATE_TEST_SUITE_P(Scenes, WarpValues, ::testing::ValuesIn(all_scene_names()), scene_name);

/// Largest sample, and largest differences of neighbors summed over the axes.
struct Extent {
  double largest = 0;
  double slope = 0;
};

Extent extent_of(const Volume& volume) {
  const std::vector<double> samples = numbers_of(volume);
  Extent extent;
  for (const double sample : samples) {
    extent.largest = std::max(extent.largest, std::abs(sample));
  }
  const auto components = static_cast<std::size_t>(volume.components);
  std::size_t stride = components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto count = static_cast<std::size_t>(volume.grid.dims[axis]);
    double steepest = 0;
    for (std::size_t s = 0; s + stride < samples.size(); ++s) {
      if (s / stride % count + 1 == count) continue;
      steepest = std::max(steepest, std::abs(samples[s + stride] - samples[s]));
    }
    extent.slope += steepest;
    stride *= count;
  }
  return extent;
}

/// |x| = |base + a i + b j + c k| <= 1 + 3 * 4 * 7 in a cell. Rounding base and entries costs
/// u (1/2 + 84), products u 84, sums u (29 + 57 + 85), with u = 2^-24: less than 340 u. Steeper
/// maps are evaluated in float64. Seven blends of three roundings each cost 21 u of the samples.
double float_bound(const Extent& extent) {
  return 0x1p-24 * (340 * extent.slope + 21 * extent.largest);
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = a.size() == b.size() ? 0 : INFINITY;
  for (std::size_t v = 0; v < a.size(); ++v) largest = std::max(largest, std::abs(a[v] - b[v]));
  return largest;
}

TEST_P(WarpValues, Float32IsWithinItsBound) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32, 2);

  const Warped cpu = run_warp(source, scene(), Backend::cpu);
  const Warped reference = run_warp(source, scene(), Backend::reference);

  const double bound = float_bound(extent_of(source));
  EXPECT_LE(largest_difference(numbers_of(cpu.volume), numbers_of(reference.volume)), bound);
  EXPECT_LT(bound, 1e-5);
}

TEST_P(WarpValues, Float64IsWithin1e12) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float64);

  const Warped cpu = run_warp(source, scene(), Backend::cpu);
  const Warped reference = run_warp(source, scene(), Backend::reference);

  EXPECT_LE(largest_difference(numbers_of(cpu.volume), numbers_of(reference.volume)), 1e-12);
}

/// Against the same samples in float64: half for rounding, and what float32 costs.
TEST_P(WarpValues, IntegersAreTheNearest) {
  for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::int32}) {
    const Volume source = scenes::wavy_volume(scene().source_grid, type);
    Volume wide = make_volume(source.grid, PixelType::float64);
    std::ranges::copy(numbers_of(source), wide.samples<double>().begin());

    const auto cpu = numbers_of(run_warp(source, scene(), Backend::cpu).volume);
    const auto reference = numbers_of(run_warp(source, scene(), Backend::reference).volume);
    const auto real = numbers_of(run_warp(wide, scene(), Backend::reference).volume);

    const double bound = type == PixelType::int32 ? 1e-8 : float_bound(extent_of(source));
    EXPECT_LE(largest_difference(cpu, real), 0.5 + bound) << name_of(type);
    EXPECT_LE(largest_difference(cpu, reference), 1) << name_of(type);
  }
}

TEST_P(WarpValues, UncoveredVoxelsKeepTheirPlace) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32);
  WarpOptions options;
  options.outside = Outside::identity;
  options.background = -3;

  const Warped cpu = run_warp(source, scene(), Backend::cpu, options);
  const Warped reference = run_warp(source, scene(), Backend::reference, options);

  EXPECT_LE(largest_difference(numbers_of(cpu.volume), numbers_of(reference.volume)),
            float_bound(extent_of(source)));
  if (scene().source_grid != scene().output_grid) return;
  for (std::size_t v = 0; v < cpu.owner.size(); ++v) {
    if (cpu.owner[v] >= 0) continue;
    ASSERT_EQ(cpu.volume.samples<float>()[v], source.samples<float>()[v]);
  }
}

/// Differences are ties: positions within rounding of the middle between two voxels. There the
/// other candidate is what a position moved by the rounding would take.
TEST_P(WarpValues, NearestTakesTheReferencesSampleButForTies) {
  const scenes::Scene& scene = this->scene();
  WarpOptions options;
  options.filter = Filter::nearest;
  // The samples are the voxels' own coordinates, so that linear gives the position.
  Volume place = make_volume(scene.source_grid, PixelType::float64, 3);
  const auto& n = scene.source_grid.dims;
  for (std::size_t s = 0; s < place.samples<double>().size(); ++s) {
    const auto voxel = static_cast<std::int64_t>(s / 3);
    const std::int64_t ijk[3] = {voxel % n[0], voxel / n[0] % n[1], voxel / n[0] / n[1]};
    place.samples<double>()[s] = static_cast<double>(ijk[s % 3]);
  }
  Volume narrow = make_volume(scene.source_grid, PixelType::float32, 3);
  std::ranges::copy(numbers_of(place), narrow.samples<float>().begin());

  const auto cpu = numbers_of(run_warp(narrow, scene, Backend::cpu, options).volume);
  const auto reference = numbers_of(run_warp(place, scene, Backend::reference, options).volume);
  const auto position = numbers_of(run_warp(place, scene, Backend::reference).volume);

  for (std::size_t s = 0; s < cpu.size(); ++s) {
    if (cpu[s] == reference[s]) continue;
    ASSERT_EQ(std::abs(cpu[s] - reference[s]), 1);
    ASSERT_NEAR(position[s] - std::floor(position[s]), 0.5, 340 * 0x1p-24);
  }
}
}  // namespace
}  // namespace tetwarp::test

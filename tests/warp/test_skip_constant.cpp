/// @file test_skip_constant.cpp
/// Filling cells that read one value of the source gives the same bits as sampling them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "host/base/pixel_dispatch.hpp"
#include "tests/support/skip_series.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
/// Waves in the lower third, above them air of one value, and far up another.
Volume airy_volume(const Grid& grid, PixelType type, int components = 1) {
  Volume volume = scenes::wavy_volume(grid, type, components);
  with_pixel_type(type, [&]<class T>(T) {
    const auto samples = volume.samples<T>();
    const auto slice = samples.size() / static_cast<std::size_t>(grid.dims[2]);
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const auto k = static_cast<std::int64_t>(s / slice);
      const auto c = s % static_cast<std::size_t>(components);
      if (3 * k > grid.dims[2]) samples[s] = static_cast<T>(c);
      if (10 * k > 9 * grid.dims[2]) samples[s] = static_cast<T>(3 + c);
    }
  });
  return volume;
}

/// Outputs with the skip on and off, the same in every bit; the count with it on.
std::int64_t expect_same(const std::vector<Volume>& sources,
                         const scenes::Scene& scene,
                         WarpOptions options = {}) {
  options.backend = Backend::cpu;
  options.threads = 1;
  options.expert.skip.constant_cells = true;
  Series on(sources, scene, options);
  options.expert.skip.constant_cells = false;
  Series off(sources, scene, options);
  const Counts filled = on.step(scene.deformed), sampled = off.step(scene.deformed);
  EXPECT_TRUE(on.has_bits_of(off)) << scene.name << ' ' << name_of(sources.front().type);
  EXPECT_EQ(filled.covered, sampled.covered);
  EXPECT_EQ(filled.inside_tests, sampled.inside_tests);
  EXPECT_EQ(filled.voxels_copied, sampled.voxels_copied);
  EXPECT_EQ(sampled.cells_constant, 0);
  return filled.cells_constant;
}

const std::array all_types = {PixelType::uint8,   PixelType::int8,   PixelType::uint16,
                              PixelType::int16,   PixelType::uint32, PixelType::int32,
                              PixelType::float32, PixelType::float64};

TEST(SkipConstant, GivesTheBitsOfSamplingOnEveryScene) {
  std::int64_t filled = 0;
  for (const scenes::Scene& scene : scenes::adversarial_scenes(56)) {
    filled += expect_same({airy_volume(scene.source_grid, PixelType::float32)}, scene);
    filled += expect_same({airy_volume(scene.source_grid, PixelType::int16)}, scene,
                          {.filter = Filter::nearest, .outside = Outside::identity});
  }
  EXPECT_GT(filled, 1000);
}

TEST(SkipConstant, GivesTheBitsOfSamplingForEveryPixelType) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 56);
  for (const PixelType type : all_types) {
    for (const int components : {1, 3}) {
      EXPECT_GT(expect_same({airy_volume(scene.source_grid, type, components)}, scene), 0);
    }
  }
  for (const PixelType type : {PixelType::uint64, PixelType::int64}) {
    EXPECT_GT(expect_same({airy_volume(scene.source_grid, type)}, scene,
                          {.filter = Filter::nearest, .background = 200}),
              0);
  }
}

/// The extremes of a type are unchanged by the arithmetic of sampling.
TEST(SkipConstant, GivesTheBitsOfSamplingForExtremeValues) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 40);
  for (const PixelType type : all_types) {
    with_pixel_type(type, [&]<class T>(T) {
      using Limits = std::numeric_limits<T>;
      for (const T value : {Limits::max(), Limits::lowest(), Limits::min()}) {
        Volume volume = make_volume(scene.source_grid, type);
        std::ranges::fill(volume.samples<T>(), value);
        EXPECT_GT(expect_same({volume}, scene), 0) << name_of(type);
      }
    });
  }
}

/// What interpolation changes, and zeros of either sign, are not filled with.
TEST(SkipConstant, LeavesNaNInfinitiesAndNegativeZerosToTheSampler) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 56);
  using Limits = std::numeric_limits<float>;
  for (const float odd : {Limits::quiet_NaN(), Limits::infinity(), -Limits::infinity(), -0.0f}) {
    Volume all = make_volume(scene.source_grid, PixelType::float32), few = all;
    std::ranges::fill(all.samples<float>(), odd);
    for (std::size_t s = 0; s < few.samples<float>().size(); s += 10007) {
      few.samples<float>()[s] = odd;
    }
    EXPECT_EQ(expect_same({all}, scene), 0) << odd;
    EXPECT_GT(expect_same({few}, scene), 0) << odd;
  }
}

/// Wider filters read more samples, and a spline's coefficients take some voxels to become
/// constant.
TEST(SkipConstant, GivesTheBitsOfSamplingForEveryFilter) {
  for (const Filter filter : {Filter::cubic, Filter::bspline, Filter::lanczos}) {
    const scenes::Scene scene =
        scenes::adversarial_scene("waved", filter == Filter::bspline ? 128 : 64);
    for (const PixelType type : {PixelType::uint8, PixelType::float32}) {
      const WarpOptions options{.filter = filter, .overshoot = Overshoot::clamp};
      EXPECT_GT(expect_same({airy_volume(scene.source_grid, type)}, scene, options), 0)
          << name_of(type) << ' ' << static_cast<int>(filter);
    }
  }
  const scenes::Scene scene = scenes::adversarial_scene("waved", 64);
  const Volume labels = airy_volume(scene.source_grid, PixelType::int64);
  EXPECT_GT(expect_same({labels}, scene, {.filter = Filter::labels}), 0);
}

/// One source with air and one without: each is tested on its own, the first is counted.
TEST(SkipConstant, TreatsEverySourceOnItsOwn) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 56);
  const Volume airy = airy_volume(scene.source_grid, PixelType::int16);
  const Volume wavy = scenes::wavy_volume(scene.source_grid, PixelType::float32);

  EXPECT_GT(expect_same({airy, wavy, airy}, scene), 0);
  EXPECT_EQ(expect_same({wavy, airy}, scene), 0);
}

TEST(SkipConstant, GivesTheBitsOfSamplingOnFinerAndCoarserGrids) {
  scenes::Scene scene = scenes::adversarial_scene("waved", 112);
  const Volume volume = airy_volume(scene.source_grid, PixelType::float32);
  for (const double spacing : {0.6, 0.9, 1.7, 2.6}) {
    scene.output_grid.spacing = {spacing, spacing, spacing};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto extent = static_cast<double>(scene.source_grid.dims[axis]);
      scene.output_grid.dims[axis] = static_cast<std::int64_t>(extent / spacing);
    }
    EXPECT_GT(expect_same({volume}, scene), 0) << spacing;
  }
}

/// Kept cells, filled cells and sampled cells side by side.
TEST(SkipConstant, WorksWithUpdates) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 56);
  const std::vector<Volume> sources = {airy_volume(scene.source_grid, PixelType::uint8)};
  for (const Filter filter : {Filter::linear, Filter::cubic, Filter::labels}) {
    WarpOptions options{.filter = filter, .backend = Backend::cpu};
    Series on(sources, scene, options);
    options.expert.skip.constant_cells = options.expert.skip.unchanged_tets = false;
    Series off(sources, scene, options);
    Counts sum;
    for (const auto& positions : partial_motions(scene, 79)) {
      sum += on.step(positions);
      off.step(positions);
      EXPECT_TRUE(on.has_bits_of(off));
    }
    EXPECT_GT(sum.cells_constant, 0);
    EXPECT_GT(sum.cells_unchanged, 0);
  }
}
}  // namespace
}  // namespace tetwarp::test

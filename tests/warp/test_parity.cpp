/// @file test_parity.cpp
/// cuda against cpu through the public calls: decisions bit for bit, values within a few ulp.
/// (The suites X/cuda run the tests of each stage on the kernels.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "tests/support/each_scene.hpp"
#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
class Parity : public EachScene<40> {
 protected:
  void SetUp() override {
    const BackendStatus status = cuda_status(0);
    if (!status.usable) GTEST_SKIP() << status.reason;
  }
};
INSTANTIATE_TEST_SUITE_P(Scenes, Parity, ::testing::ValuesIn(all_scene_names()), scene_name);

TEST_P(Parity, OwnersAndClassesAreTheSame) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::int16);
  WarpOptions options;
  options.count_folded = true;

  const Warped cpu = run_warp(source, scene(), Backend::cpu, options);
  const Warped cuda = run_warp(source, scene(), Backend::cuda, options);

  EXPECT_TRUE(cpu.owner == cuda.owner);
  EXPECT_TRUE(cpu.mask == cuda.mask);
  EXPECT_EQ(cpu.counts.covered, cuda.counts.covered);
  EXPECT_EQ(cpu.counts.folded, cuda.counts.folded);
  EXPECT_EQ(cpu.counts.inverted, cuda.counts.inverted);
  EXPECT_EQ(cpu.counts.flat, cuda.counts.flat);
  EXPECT_EQ(cpu.counts.cells, cuda.counts.cells);
  EXPECT_EQ(cpu.counts.candidate_pairs, cuda.counts.candidate_pairs);
  EXPECT_EQ(cpu.counts.voxels_copied, cuda.counts.voxels_copied);
}

/// A fused position differs by at most the roundings it saves: 170 u with u = 2^-24, entries at
/// most 4 and offsets of 7 voxels. Samples are below 1, neighbors differ by less than 1/8 per axis;
/// 4 ulp more for the blends.
TEST_P(Parity, Float32ValuesAreWithinAFewUlp) {
  for (const Outside outside : {Outside::background, Outside::identity}) {
    const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32, 2);
    WarpOptions options;
    options.outside = outside;

    const auto cpu = numbers_of(run_warp(source, scene(), Backend::cpu, options).volume);
    const auto cuda = numbers_of(run_warp(source, scene(), Backend::cuda, options).volume);

    ASSERT_EQ(cpu.size(), cuda.size());
    for (std::size_t s = 0; s < cpu.size(); ++s) {
      ASSERT_NEAR(cpu[s], cuda[s], 0x1p-24 * (170 * 3.0 / 8 + 4)) << "sample " << s;
    }
  }
}

TEST_P(Parity, IntegersDifferByRoundingOnlyAndFloat64By1e12) {
  for (const PixelType type : {PixelType::uint8, PixelType::int32, PixelType::float64}) {
    const Volume source = scenes::wavy_volume(scene().source_grid, type);

    const auto cpu = numbers_of(run_warp(source, scene(), Backend::cpu).volume);
    const auto cuda = numbers_of(run_warp(source, scene(), Backend::cuda).volume);

    ASSERT_EQ(cpu.size(), cuda.size());
    for (std::size_t s = 0; s < cpu.size(); ++s) {
      ASSERT_NEAR(cpu[s], cuda[s], is_integer(type) ? 1 : 1e-12) << "sample " << s;
    }
  }
}

/// As above, with slopes of up to six differences of neighbors and 60 ulp for weights and sums.
TEST_P(Parity, FiltersAreWithinAFewUlp) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32);
  for (const Filter filter : {Filter::cubic, Filter::bspline, Filter::lanczos}) {
    const WarpOptions options{.filter = filter, .overshoot = Overshoot::clamp};

    const auto cpu = numbers_of(run_warp(source, scene(), Backend::cpu, options).volume);
    const auto cuda = numbers_of(run_warp(source, scene(), Backend::cuda, options).volume);

    ASSERT_EQ(cpu.size(), cuda.size());
    for (std::size_t s = 0; s < cpu.size(); ++s) {
      ASSERT_NEAR(cpu[s], cuda[s], 0x1p-24 * (6 * 170 * 3.0 / 8 + 60)) << "sample " << s;
    }
  }
}

/// A label has no tolerance: where the interpolated indicators of two are nearly the same, fused
/// multiply-add may choose the other one. Indicators of neighbors differ by up to 1 per axis, so
/// that by the bound of positions above each differs by at most 3 x 170 u and 4 ulp for the blends.
TEST_P(Parity, LabelsDifferOnlyWhereTheirWeightsTie) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::uint8);
  const WarpOptions options{.filter = Filter::labels};
  std::map<double, std::vector<double>> indicators;
  const auto indicator = [&](double label) -> const std::vector<double>& {
    std::vector<double>& samples = indicators[label];
    if (samples.empty()) {
      Volume one = make_volume(scene().source_grid, PixelType::float32, 1);
      std::ranges::transform(source.samples<std::uint8_t>(), one.samples<float>().begin(),
                             [label](std::uint8_t sample) { return sample == label ? 1.f : 0.f; });
      samples = numbers_of(run_warp(one, scene(), Backend::cpu).volume);
    }
    return samples;
  };

  const auto cpu = numbers_of(run_warp(source, scene(), Backend::cpu, options).volume);
  const auto cuda = numbers_of(run_warp(source, scene(), Backend::cuda, options).volume);

  ASSERT_EQ(cpu.size(), cuda.size());
  for (std::size_t s = 0; s < cpu.size(); ++s) {
    if (cpu[s] == cuda[s]) continue;
    EXPECT_NEAR(indicator(cpu[s])[s], indicator(cuda[s])[s], 2 * 0x1p-24 * (3 * 170 + 4)) << s;
  }
}

/// A step that needs more pairs than the one before runs again with more room.
TEST_P(Parity, StepsThatGrowAndShrinkAreTheSame) {
  const scenes::Scene& scene = this->scene();
  const Volume source = scenes::wavy_volume(scene.source_grid, PixelType::int16);
  WarpOptions options;
  options.output_grid = scene.output_grid;
  options.backend = Backend::cuda;
  Warper warper(source, scene.mesh, options);
  Point3 center = scene.output_grid.world_of({20, 18, 21});
  for (const double scale : {0.1, 1.0, 0.3, 1.0}) {
    scenes::Scene step = scene;
    for (Point3& p : step.deformed) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        p[axis] = center[axis] + scale * (p[axis] - center[axis]);
      }
    }

    const Warped cuda = run_step(warper, source, step.deformed);

    EXPECT_TRUE(cuda.owner == run_warp(source, step, Backend::cpu).owner) << scale;
  }
}

TEST_P(Parity, RepeatedRunsGiveTheSameBits) {
  const Volume source = scenes::wavy_volume(scene().source_grid, PixelType::float32);

  const Warped first = run_warp(source, scene(), Backend::cuda);
  const Warped second = run_warp(source, scene(), Backend::cuda);

  EXPECT_EQ(first.volume.data, second.volume.data);
  EXPECT_TRUE(first.owner == second.owner);
}
}  // namespace
}  // namespace tetwarp::test

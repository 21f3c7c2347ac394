/// @file test_warp.cpp
/// What a warp must keep exactly: whole-voxel moves, affine maps of ramps, samples that are not
/// numbers, wide integers, rounding.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/warp_run.hpp"

namespace tetwarp::test {
namespace {
const std::vector<PixelType> all_types = {
    PixelType::uint8, PixelType::int8,   PixelType::uint16, PixelType::int16,   PixelType::uint32,
    PixelType::int32, PixelType::uint64, PixelType::int64,  PixelType::float32, PixelType::float64};

Filter filter_of(PixelType type) {
  const bool wide = is_integer(type) && size_of(type) == 8;
  return wide ? Filter::nearest : Filter::linear;
}

/// Every bit pattern, signaling NaNs, infinities and subnormals among them.
Volume random_bits(const Grid& grid, PixelType type, int components) {
  Volume volume = make_volume(grid, type, components);
  for (std::size_t b = 0; b < volume.data.size(); ++b) {
    volume.data[b] = static_cast<std::byte>(256 * scenes::uniform(77, b));
  }
  return volume;
}

/// The same with signaling NaNs made quiet, as any arithmetic on them may do.
Volume quieted(Volume volume) {
  if (volume.type == PixelType::float32) {
    for (float& sample : volume.samples<float>()) {
      const auto bits = std::bit_cast<std::uint32_t>(sample);
      if (std::isnan(sample)) sample = std::bit_cast<float>(bits | 1u << 22);
    }
  }
  if (volume.type == PixelType::float64) {
    for (double& sample : volume.samples<double>()) {
      const auto bits = std::bit_cast<std::uint64_t>(sample);
      if (std::isnan(sample)) sample = std::bit_cast<double>(bits | std::uint64_t{1} << 51);
    }
  }
  return volume;
}

/// Where voxel (i, j, k) of `to` holds voxel (i, j, k) - shift of `from` bit for bit, and zero bits
/// where that is no voxel.
bool is_shifted(const Volume& from, const Volume& to, const std::array<std::int64_t, 3>& shift) {
  const auto& n = from.grid.dims;
  const auto size = size_of(from.type) * static_cast<std::size_t>(from.components);
  const std::vector<std::byte> zero(size);
  const auto voxel = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return size * static_cast<std::size_t>((k * n[1] + j) * n[0] + i);
  };
  for (std::int64_t k = 0; k < n[2]; ++k) {
    for (std::int64_t j = 0; j < n[1]; ++j) {
      for (std::int64_t i = 0; i < n[0]; ++i) {
        const std::int64_t x = i - shift[0], y = j - shift[1], z = k - shift[2];
        const bool within = x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2];
        const std::byte* expected = within ? &from.data[voxel(x, y, z)] : zero.data();
        if (std::memcmp(&to.data[voxel(i, j, k)], expected, size) != 0) return false;
      }
    }
  }
  return true;
}

class WarpTypes : public ::testing::TestWithParam<PixelType> {};
INSTANTIATE_TEST_SUITE_P(Warp, WarpTypes, ::testing::ValuesIn(all_types), [](const auto& info) {
  return std::string(name_of(info.param));
});

/// Identity, last slab included, and shifts by whole voxels; with and without the copying path.
TEST_P(WarpTypes, WholeVoxelMovesKeepEveryBit) {
  for (const Grid& grid : {scenes::unit_grid(19, 17, 21), scenes::oblique_grid(17, 19, 13)}) {
    for (const int components : {1, 3}) {
      const Volume bits = random_bits(grid, GetParam(), components);
      const Mesh mesh = covering_mesh(grid);
      for (const std::array<std::int64_t, 3>& shift :
           {std::array<std::int64_t, 3>{0, 0, 0}, {3, 0, -2}, {-5, 8, 1}}) {
        const Point3 voxels = {static_cast<double>(shift[0]), static_cast<double>(shift[1]),
                               static_cast<double>(shift[2])};
        for (const bool copies : {true, false}) {
          const Volume source = copies ? bits : quieted(bits);
          WarpOptions options;
          options.filter = filter_of(GetParam());
          options.expert.skip.copied_voxels = copies;
          options.backend = Backend::cpu;
          const WarpResult result =
              warp(source, mesh, moved(grid, mesh.rest_positions, voxels), options);

          EXPECT_TRUE(is_shifted(source, result.volume, shift))
              << "shift " << shift[0] << ' ' << shift[1] << ' ' << shift[2];
          const Counts& counts = result.report.counts;
          EXPECT_EQ(counts.voxels_copied, copies ? counts.covered : 0);
        }
      }
    }
  }
}

TEST_P(WarpTypes, TheBackgroundIsRoundedAndSaturated) {
  const Grid grid = scenes::unit_grid(9, 9, 9);
  const Mesh mesh = covering_mesh(grid);
  WarpOptions options;
  options.filter = filter_of(GetParam());
  options.backend = Backend::cpu;
  const auto far_away = moved(grid, mesh.rest_positions, {50, 0, 0});
  for (const double background : {2.5, -1e30, 1e30}) {
    options.background = background;
    const Volume volume = warp(random_bits(grid, GetParam(), 1), mesh, far_away, options).volume;

    with_pixel_type(GetParam(), [&]<class T>(T) {
      using Limits = std::numeric_limits<T>;
      const T expected = !is_integer(GetParam()) ? static_cast<T>(background)
                         : background == 2.5     ? T{2}
                         : background < 0        ? Limits::lowest()
                                                 : Limits::max();
      EXPECT_EQ(std::ranges::count(volume.samples<T>(), expected), grid.voxel_count());
    });
  }
}

/// x -> A x + b, the same for all nodes: a ramp stays a ramp. |A^-1| < 1.5 per entry.
TEST(Warp, AnAffineMapOfARampIsARamp) {
  const Grid grid = scenes::unit_grid(40, 36, 32);
  const std::array<double, 4> ramp = {3, 0.5, -0.25, 0.125};
  const Volume source = scenes::ramp_volume(grid, ramp);
  const Mesh mesh = scenes::lattice({3, 3, 3}, {0, 0, 0}, {39, 35, 31});
  const auto deformed = scenes::rotated_45_45(mesh.rest_positions, {20, 18, 16});
  const scenes::Scene scene = {"ramp", mesh, deformed, grid, grid};

  const Warped warped = run_warp(source, scene, Backend::cpu);

  // The rotation is undone: R^T (x - c) + c with R of rotated_45_45().
  const double h = std::sqrt(0.5);
  // Positions in a cell are below 1 + 3 * 7 * 1.5 < 33 and take 6 roundings; nodes are rounded to
  // 2^-21 voxel at both ends. Samples are exact and below 32, each of 7 blends rounds thrice.
  const double position = 6 * 33 * 0x1p-24 + 8 * 0x1p-21;
  const double bound = (0.5 + 0.25 + 0.125) * position + 21 * 32 * 0x1p-24;
  std::size_t v = 0;
  for (int k = 0; k < 32; ++k) {
    for (int j = 0; j < 36; ++j) {
      for (int i = 0; i < 40; ++i, ++v) {
        if (warped.owner[v] < 0) continue;
        const double x = i - 20, y = j - 18, z = k - 16;
        const double turned = h * (y + z);
        const Point3 from = {20 + h * (x + turned), 18 + h * (turned - x), 16 + h * (z - y)};
        const double expected = ramp[0] + ramp[1] * from[0] + ramp[2] * from[1] + ramp[3] * from[2];
        ASSERT_NEAR(warped.volume.samples<float>()[v], expected, bound);
      }
    }
  }
  EXPECT_GT(warped.counts.covered, 10000);
}

/// With samples marked at one voxel, the voxels that blend it are those within a voxel of it.
TEST(Warp, ASampleThatIsNotANumberReachesOnlyWhatBlendsIt) {
  const Grid grid = scenes::unit_grid(24, 24, 24);
  const Mesh mesh = covering_mesh(grid);
  const scenes::Scene scene = {"nan", mesh, scenes::waved(mesh.rest_positions, 2.0, 3), grid, grid};
  for (const float odd :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Volume plain = make_volume(grid, PixelType::float32), marked = plain, poisoned = plain;
    const std::size_t at = (11 * 24 + 12) * 24 + 13;
    marked.samples<float>()[at] = 1;
    poisoned.samples<float>()[at] = odd;

    const Warped weight = run_warp(marked, scene, Backend::cpu);
    const Warped warped = run_warp(poisoned, scene, Backend::cpu);

    std::int64_t reached = 0;
    for (std::size_t v = 0; v < weight.owner.size(); ++v) {
      const bool blends = weight.volume.samples<float>()[v] > 0;
      ASSERT_EQ(std::isfinite(warped.volume.samples<float>()[v]), !blends) << "voxel " << v;
      reached += blends;
    }
    EXPECT_GT(reached, 0);
    EXPECT_LT(reached, 64);
  }
}

/// 2^53 + 1 and its neighbors have no float64, so a conversion to it would change them.
TEST(Warp, NearestKeepsWideIntegersExact) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  Volume source = make_volume(scene.source_grid, PixelType::uint64);
  std::uint64_t value = (std::uint64_t{1} << 53) + 1;
  for (std::uint64_t& sample : source.samples<std::uint64_t>()) sample = value += 2;
  WarpOptions options;
  options.filter = Filter::nearest;

  const Warped cpu = run_warp(source, scene, Backend::cpu, options);
  const Warped reference = run_warp(source, scene, Backend::reference, options);

  std::int64_t differ = 0;
  for (std::size_t v = 0; v < cpu.owner.size(); ++v) {
    const std::uint64_t sample = cpu.volume.samples<std::uint64_t>()[v];
    ASSERT_TRUE(sample == 0 || sample % 2 == 1);
    differ += sample != reference.volume.samples<std::uint64_t>()[v];
  }
  EXPECT_LE(differ, 2);  // positions within rounding of the middle between two voxels
}

/// A stretch by two along x: every second voxel lies in the middle of two samples. All lengths are
/// powers of two, so that it does so exactly.
TEST(Warp, IntegersRoundHalfToEven) {
  const Grid grid = scenes::unit_grid(8, 2, 2);
  Volume source = make_volume(grid, PixelType::uint8);
  for (std::size_t s = 0; s < 32; ++s) {
    source.samples<std::uint8_t>()[s] = static_cast<std::uint8_t>(s % 8);
  }
  const Mesh mesh = scenes::lattice({1, 1, 1}, {0, 0, 0}, {8, 2, 2});
  std::vector<Point3> deformed = mesh.rest_positions;
  for (Point3& p : deformed) p[0] *= 2;
  for (const Backend backend : {Backend::cpu, Backend::reference}) {
    WarpOptions options;
    options.backend = backend;
    const Volume volume = warp(source, mesh, deformed, options).volume;

    const auto samples = volume.samples<std::uint8_t>();
    EXPECT_EQ(std::vector(samples.begin(), samples.begin() + 8),
              (std::vector<std::uint8_t>{0, 0, 1, 2, 2, 2, 3, 4}));
  }
}

/// Sources of fewer bytes than a machine word, enlarged.
TEST(Warp, TheSmallestSourcesAreSampledLikeOthers) {
  for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::float32}) {
    for (const Grid& grid : {scenes::unit_grid(1, 1, 1), scenes::unit_grid(2, 1, 1),
                             scenes::unit_grid(1, 3, 1), scenes::unit_grid(1, 1, 5)}) {
      scenes::Scene scene = {"small", covering_mesh(grid), {}, grid, scenes::unit_grid(17, 17, 17)};
      for (Point3 p : scene.mesh.rest_positions) {
        for (double& x : p) x = 3.1 * x + 2.3;
        scene.deformed.push_back(p);
      }
      const Volume source = scenes::wavy_volume(grid, type);

      const auto cpu = numbers_of(run_warp(source, scene, Backend::cpu).volume);
      const auto reference = numbers_of(run_warp(source, scene, Backend::reference).volume);

      // Samples of float32 are below 1 and neighbors differ by less than 1/4.
      const double bound = is_integer(type) ? 1 : 0x1p-20;
      EXPECT_TRUE(std::ranges::equal(cpu, reference,
                                     [=](double a, double b) { return std::abs(a - b) <= bound; }));
      EXPECT_GT(std::ranges::max(cpu), 0);
    }
  }
}

/// Interpolation between equal samples at the end of the range gives that sample.
TEST(Warp, IntegersSaturate) {
  const scenes::Scene scene = scenes::adversarial_scene("waved", 24);
  for (const PixelType type : {PixelType::uint8, PixelType::int16, PixelType::uint32}) {
    Volume source = make_volume(scene.source_grid, type);
    with_pixel_type(type, [&]<class T>(T) {
      std::ranges::fill(source.samples<T>(), std::numeric_limits<T>::max());
      const Warped warped = run_warp(source, scene, Backend::cpu);
      EXPECT_EQ(std::ranges::count(warped.volume.samples<T>(), std::numeric_limits<T>::max()),
                warped.counts.covered);
    });
  }
}
}  // namespace
}  // namespace tetwarp::test

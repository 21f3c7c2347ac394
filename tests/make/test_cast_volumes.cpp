/// @file test_cast_volumes.cpp
/// Ray-cast pictures against closed forms, and among surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <tetwarp/cast.hpp>
#include <tetwarp/make.hpp>

#include "tests/support/make_checks.hpp"

namespace tetwarp {
namespace {
using make_checks::contains;
using make_checks::message_of;

constexpr double rounding = 0.5 / 255 + 1e-9;  // of a pixel
constexpr double cut = 1.2e-3;                 // where a ray ends, and rounding of its depth

/// A slab of one value across the line of sight, a voxel less than 4 deep per voxel of spacing 0.5.
Volume slab(std::int64_t deep, float value) {
  Volume volume =
      make_volume({{40, deep, 40}, {-9.75, 0.25, -9.75}, {0.5, 0.5, 0.5}}, PixelType::float32);
  std::ranges::fill(volume.samples<float>(), value);
  return volume;
}

/// From -y, so far away that rays through the middle are nearly parallel.
SurfaceRenderOptions frontal() {
  SurfaceRenderOptions options;
  options.camera = {{0, -200, 0}, {0, 0, 0}, {0, 0, 1}, 0.02};
  options.width = options.height = 9;
  return options;
}

std::array<double, 3> middle_of(const Image& image) {
  const auto at = static_cast<std::size_t>(3 * (image.height / 2 * image.width + image.width / 2));
  return {image.rgb[at] / 255.0, image.rgb[at + 1] / 255.0, image.rgb[at + 2] / 255.0};
}

TransferFunction constant(const std::array<double, 3>& color, double opacity, double length) {
  return {{{0, color, opacity}}, length};
}

Image cast_one(const Volume& volume, const TransferFunction& colors, double step = 0.5) {
  const CastVolume cast{&volume, colors};
  return cast_volumes({&cast, 1}, {}, {}, frontal(), step);
}

TEST(CastVolumes, ATransparentVolumeShowsWhatSurfacesShow) {
  const Volume volume = slab(8, 3);
  const Image empty = render_surfaces({}, {}, frontal());

  EXPECT_EQ(cast_one(volume, constant({1, 0, 0}, 0, 1)).rgb, empty.rgb);
  EXPECT_EQ(cast_volumes({}, {}, {}, frontal()).rgb, empty.rgb);
}

TEST(CastVolumes, AnOpaqueVolumeShowsItsColor) {
  const std::array<double, 3> color{0.2, 0.6, 1};

  const auto shown = middle_of(cast_one(slab(8, 3), constant(color, 1, 1)));

  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], color[c], rounding);
}

/// What is hidden of the background through a slab of depth d is 1 - exp(-mu d), for any step.
TEST(CastVolumes, ASlabHidesByItsDepthWhateverTheStep) {
  const double behind = middle_of(render_surfaces({}, {}, frontal()))[0];
  for (const double opacity : {0.01, 0.3, 0.9}) {
    for (const std::int64_t deep : {1, 2, 13}) {
      const double mu = -std::log(1 - opacity) / 1.7;
      const double hidden = 1 - std::exp(-mu * 0.5 * static_cast<double>(deep));
      const TransferFunction colors = constant({0, 0, 0}, opacity, 1.7);
      for (const double step : {0.07, 0.5, 1.0, 3.3, 1000.0}) {
        const double shown = middle_of(cast_one(slab(deep, 1), colors, step))[0];
        EXPECT_NEAR(shown, (1 - hidden) * behind, 2 * rounding + cut)
            << opacity << ' ' << deep << ' ' << step;
      }
    }
  }
}

/// Value and opacity rise linearly with depth: the extinction integrates in closed form.
TEST(CastVolumes, ARampApproachesItsIntegral) {
  const double behind = middle_of(render_surfaces({}, {}, frontal()))[0];
  constexpr std::int64_t deep = 24;
  Volume volume = slab(deep, 0);
  const auto samples = volume.samples<float>();
  for (std::size_t v = 0; v < samples.size(); ++v) {
    samples[v] = static_cast<float>(v / 40 % deep) / (deep - 1);
  }
  const TransferFunction colors{{{0, {0, 0, 0}, 0}, {1, {0, 0, 0}, 0.5}}, 4};
  // Half a voxel of opacity 0.5 at the end; before it the integral of -log(1 - s / 2) ds.
  const double ramp = 0.5 * (deep - 1) * (1 - std::log(2)) / 4;
  const double hidden = 1 - std::exp(-ramp - 0.25 * std::log(2) / 4);

  EXPECT_NEAR(middle_of(cast_one(volume, colors, 0.25))[0], (1 - hidden) * behind,
              2 * rounding + cut);
}

TEST(CastVolumes, VolumesThatOverlapAddUpAndThoseBehindAreHidden) {
  const Volume volume = slab(4, 1);
  Volume behind = volume;
  behind.grid.origin[1] += 5;
  const CastVolume half{&volume, constant({1, 0, 0}, 0.5, 2)};
  const CastVolume twice{&volume, constant({1, 0, 0}, 0.75, 2)};
  const CastVolume wall{&behind, constant({0, 1, 0}, 1, 2)};
  const std::array overlapping{half, half};

  const Image sum = cast_volumes(overlapping, {}, {}, frontal());
  const auto seen = middle_of(cast_volumes(std::array{wall, half}, {}, {}, frontal()));

  const auto expected = middle_of(cast_volumes({&twice, 1}, {}, {}, frontal()));
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(middle_of(sum)[c], expected[c], 2 * rounding);
  EXPECT_NEAR(seen[0], 0.5, 2 * rounding);
  EXPECT_NEAR(seen[1], 0.5, 2 * rounding);
  EXPECT_NEAR(seen[2], 0, rounding);
}

/// A surface in front hides the volume, one behind is seen through it, one within it half of it.
TEST(CastVolumes, SurfacesStandWhereTheyAre) {
  const Volume volume = slab(4, 1);
  const CastVolume cast{&volume, constant({0, 0, 0}, 0.75, 2)};
  std::vector<Point3> points{{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}};
  const std::vector<std::array<std::int32_t, 3>> triangles{{0, 1, 2}, {0, 2, 3}};
  const double share[] = {1, 0.5, 0.25};
  const double place[] = {-1, 1, 5};
  for (std::size_t n = 0; n < 3; ++n) {
    for (Point3& point : points) point[1] = place[n];
    const DrawnSurface wall{points, triangles, {0.8, 0.8, 0.8}};
    const auto alone = middle_of(render_surfaces({&wall, 1}, {}, frontal()));
    const auto shown = middle_of(cast_volumes({&cast, 1}, {&wall, 1}, {}, frontal()));
    EXPECT_NEAR(shown[1], share[n] * alone[1], 2 * rounding) << place[n];
  }
}

/// The norm of a voxel's components, held beyond the border.
double voxel_of(const Volume& volume, std::array<std::int64_t, 3> at) {
  for (std::size_t d = 0; d < 3; ++d) {
    at[d] = std::clamp<std::int64_t>(at[d], 0, volume.grid.dims[d] - 1);
  }
  const std::int64_t voxel = (at[2] * volume.grid.dims[1] + at[1]) * volume.grid.dims[0] + at[0];
  double sum = 0;
  for (int c = 0; c < volume.components; ++c) {
    const double sample =
        volume.samples<float>()[static_cast<std::size_t>(voxel * volume.components + c)];
    sum += sample * sample;
  }
  return std::sqrt(sum);
}

/// Red through a volume turned about z by `turn`, along y through x = z = 0, over white: a plain
/// sum. Opacity per unit of length is min(0.9 value, 0.9), red everywhere.
double plain_clear(const Volume& volume, double turn) {
  const Grid& grid = volume.grid;
  double depth = 0;
  constexpr double piece = 0.002;
  for (double y = -12 + piece / 2; y < 12; y += piece) {
    const Point3 from{-grid.origin[0], y - grid.origin[1], -grid.origin[2]};
    const Point3 index{(std::cos(turn) * from[0] + std::sin(turn) * from[1]) / grid.spacing[0],
                       (std::cos(turn) * from[1] - std::sin(turn) * from[0]) / grid.spacing[1],
                       from[2] / grid.spacing[2]};
    bool is_inside = true;
    double value = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      is_inside &= index[d] > -0.5 && index[d] < static_cast<double>(grid.dims[d]) - 0.5;
    }
    if (!is_inside) continue;
    for (int corner = 0; corner < 8; ++corner) {
      std::array<std::int64_t, 3> at{};
      double weight = 1;
      for (std::size_t d = 0; d < 3; ++d) {
        const double low = std::floor(index[d]);
        const bool is_upper = (corner >> d & 1) != 0;
        at[d] = static_cast<std::int64_t>(low) + is_upper;
        weight *= is_upper ? index[d] - low : 1 - index[d] + low;
      }
      value += weight * voxel_of(volume, at);
    }
    depth -= piece * std::log(1 - std::min(0.9 * value, 0.9));
  }
  return std::exp(-depth);
}

/// Blocks that are left out, turned grids, several components, few opaque voxels.
TEST(CastVolumes, EqualsAPlainSumAlongTheRay) {
  const double behind = middle_of(render_surfaces({}, {}, frontal()))[1];
  std::mt19937 random(7);
  std::uniform_real_distribution<double> number(0, 1);
  const TransferFunction colors{{{0, {1, 0, 0}, 0}, {1, {1, 0, 0}, 0.9}}, 1};
  int hidden = 0;
  for (int round = 0; round < 40; ++round) {
    const double turn = 0.3 * round;
    Volume volume = make_volume(
        {{21, 17, 30},
         {-6.3 * number(random), -3, -7.5 * number(random)},
         {0.3, 0.35, 0.25},
         {std::cos(turn), -std::sin(turn), 0, std::sin(turn), std::cos(turn), 0, 0, 0, 1}},
        PixelType::float32, 1 + round % 2);
    for (float& sample : volume.samples<float>()) {
      sample = number(random) < 0.05 ? static_cast<float>(number(random)) : 0.0f;
    }
    const double clear = plain_clear(volume, turn);
    hidden += clear < 0.9;

    const auto shown = middle_of(cast_one(volume, colors, 0.05));

    EXPECT_NEAR(shown[1], clear * behind, 2 * rounding + cut) << round;
  }
  EXPECT_GE(hidden, 10);
}

TEST(CastVolumes, TakesNotANumberForTheFirstPoint) {
  const Volume volume = slab(4, std::numeric_limits<float>::quiet_NaN());
  const Image empty = render_surfaces({}, {}, frontal());

  EXPECT_EQ(cast_one(volume, {{{0, {1, 1, 1}, 0}, {1, {1, 1, 1}, 1}}, 1}).rgb, empty.rgb);
  EXPECT_NEAR(middle_of(cast_one(volume, {{{0, {0, 0, 1}, 1}, {1, {}, 0}}, 1}))[2], 1, rounding);
}

TEST(CastVolumes, PresetsFollowHounsfieldUnitsOrTheRange) {
  EXPECT_EQ(preset_colors("ct", -1000, 1500).back().value, 1000);
  EXPECT_EQ(preset_colors("ct", 0, 2).back().value, 2);
  EXPECT_EQ(preset_colors("mr", -1000, 1500).front().value, -1000);
  EXPECT_TRUE(contains(message_of([] { preset_colors("pet", 0, 1); }), "pet"));
}

TEST(CastVolumes, NamesWhatIsWrong) {
  const Volume volume = slab(2, 1);
  const auto message = [&](const TransferFunction& colors, double step) {
    return message_of([&] { cast_one(volume, colors, step); });
  };
  EXPECT_TRUE(contains(message({{}, 1}, 0.5), "no points"));
  EXPECT_TRUE(contains(message({{{1, {}, 0}, {0, {}, 0}}, 1}, 0.5), "point 1"));
  EXPECT_TRUE(contains(message({{{1, {}, 1.5}}, 1}, 0.5), "from 0 to 1"));
  EXPECT_TRUE(contains(message({{{1, {}, 0.5}}, 0}, 0.5), "length"));
  EXPECT_TRUE(contains(message(constant({}, 0.5, 1), 0), "step"));
  Volume cut_off = volume;
  cut_off.data.pop_back();
  EXPECT_NE(message_of([&] { cast_one(cut_off, constant({}, 0.5, 1)); }), "");
}

}  // namespace
}  // namespace tetwarp

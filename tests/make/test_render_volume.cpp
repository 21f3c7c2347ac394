/// @file test_render_volume.cpp
/// Pictures: sizes, proportions, orientation, window.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <tetwarp/make.hpp>

#include "tests/support/make_checks.hpp"

namespace tetwarp {
namespace {
using make_checks::contains;
using make_checks::message_of;
using make_checks::PixelTypes;

std::uint8_t gray_at(const Image& image, int x, int y) {
  return image.rgb[static_cast<std::size_t>(3 * (y * image.width + x))];
}

/// 8 x 4 x 2 voxels, value = i in the lower half (k = 0), 100 in the upper.
template <class T>
Volume ramp() {
  Grid grid;
  grid.dims = {8, 4, 2};
  grid.spacing = {1, 2, 4};
  Volume volume = make_volume(grid, pixel_type_of<T>());
  const auto samples = volume.samples<T>();
  for (std::size_t v = 0; v < samples.size(); ++v) {
    samples[v] = v < 32 ? static_cast<T>(v % 8) : T{100};
  }
  return volume;
}

/// Automatic window, panels of this height.
RenderOptions high(int height) {
  return {.low = {}, .high = {}, .height = height};
}

Image picture_of(const Volume& volume, const RenderOptions& options) {
  return render(std::array<const Volume*, 1>{&volume}, options);
}

TEST(Render, PanelsHaveTrueProportions) {
  // 8 x 8 x 8 in world units: square panels, one pixel between them.
  const Image image = picture_of(ramp<float>(), high(40));
  EXPECT_EQ(image.height, 40);
  EXPECT_EQ(image.width, 4 * 40 + 3);
  EXPECT_EQ(image.rgb.size(), static_cast<std::size_t>(3 * image.width * image.height));
  Volume flat = ramp<float>();
  flat.grid.spacing = {1, 4, 4};
  const Image wide = picture_of(flat, high(40));
  EXPECT_EQ(wide.width, 20 + 40 + 80 + 40 + 3);
}

TEST(Render, PutsTheHeadUpAndTheWindowOnTheValues) {
  const Image image = picture_of(ramp<float>(), {.low = 0.0, .high = 200.0, .height = 40});
  const int coronal = 41 + 20;
  EXPECT_EQ(gray_at(image, coronal, 0), 128);  // 100 of 200, on top
  EXPECT_EQ(gray_at(image, coronal, 39), 5);   // i = 3.6 at the bottom
  EXPECT_EQ(gray_at(image, 40, 20), 48);       // between the panels
  EXPECT_EQ(gray_at(image, 20, 20), 128);      // axial: slice k = 1
  const Image bright = picture_of(ramp<float>(), {.low = -2.0, .high = -1.0, .height = 40});
  EXPECT_EQ(gray_at(bright, coronal, 39), 255);
}

TEST(Render, ProjectionShowsTheLargestValueOnTheWay) {
  Volume volume = ramp<float>();
  volume.samples<float>()[8 + 5] = 100;  // j = 1, k = 0; the coronal slice is j = 2
  const Image image = picture_of(volume, {.low = 0.0, .high = 100.0, .height = 80});
  const int x = 55;  // center of voxel 5
  const int y = 60;  // center of k = 0
  EXPECT_LT(gray_at(image, 81 + x, y), 20);
  EXPECT_GT(gray_at(image, 3 * 81 + x, y), 240);
}

TEST(Render, RowsShareTheFirstWindow) {
  const Volume first = ramp<float>();
  Volume second = first;
  for (float& sample : second.samples<float>()) sample *= 0.5f;
  const std::array<const Volume*, 2> both{&first, &second};
  const Image image = render(both, high(40));
  EXPECT_EQ(image.height, 81);
  EXPECT_EQ(gray_at(image, 61, 0), 255);
  EXPECT_EQ(gray_at(image, 61, 41), 128);
  EXPECT_EQ(image.rgb, render(both, high(40)).rgb);
}

template <class T>
class RenderOf : public ::testing::Test {};
TYPED_TEST_SUITE(RenderOf, PixelTypes);

TYPED_TEST(RenderOf, LooksTheSameForEveryPixelType) {
  const RenderOptions options{.low = 0.0, .high = 100.0, .height = 40};
  EXPECT_EQ(picture_of(ramp<TypeParam>(), options).rgb, picture_of(ramp<float>(), options).rgb);
}

TEST(Render, DrawsTheNormOfVectors) {
  Grid grid;
  grid.dims = {4, 4, 4};
  Volume vectors = make_volume(grid, PixelType::int16, 2);
  for (std::size_t s = 0; s < 128; ++s) vectors.samples<std::int16_t>()[s] = s % 2 ? -4 : 3;
  const Image image = picture_of(vectors, {.low = 0.0, .high = 10.0, .height = 40});
  EXPECT_EQ(gray_at(image, 20, 20), 128);
}

TEST(Render, AcceptsConstantAndNonFiniteVolumes) {
  Grid grid;
  grid.dims = {4, 4, 4};
  Volume volume = make_volume(grid, PixelType::float32);
  EXPECT_EQ(gray_at(picture_of(volume, high(40)), 20, 20), 0);
  const auto samples = volume.samples<float>();
  std::fill(samples.begin(), samples.end(), std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(gray_at(picture_of(volume, high(40)), 20, 20), 0);
  for (std::size_t s = 0; s < 32; ++s) samples[s] = static_cast<float>(s);
  samples[63] = std::numeric_limits<float>::infinity();
  const Image image = picture_of(volume, high(40));
  EXPECT_EQ(gray_at(image, 0, 0), 0);
  EXPECT_GT(gray_at(image, 41 + 39, 39), 0);
}

TEST(Render, BadArgumentsAreNamed) {
  const Volume volume = ramp<float>();
  EXPECT_EQ(message_of([] { render({}); }), "render: no volume");
  EXPECT_TRUE(contains(message_of([] { render(std::array<const Volume*, 1>{nullptr}); }), "null"));
  EXPECT_TRUE(contains(message_of([&] { picture_of(volume, high(0)); }), "height 0"));
  EXPECT_TRUE(contains(message_of([&] { picture_of(volume, {.low = 3.0, .high = 3.0}); }),
                       "low 3.000000 is not below high 3.000000"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(
      contains(message_of([&] { picture_of(volume, {.low = nan, .high = {}}); }), "not finite"));
}
}  // namespace
}  // namespace tetwarp

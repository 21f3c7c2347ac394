/// @file test_isosurface.cpp
/// Isosurfaces of images: closed, outwards, of second order, closed at the image's border.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "host/scene/isosurface.hpp"
#include "host/scene/shapes/surface.hpp"
#include "tests/scene/image_samples.hpp"
#include "tests/scene/surface_checks.hpp"
#include "tests/support/message_of.hpp"

namespace tetwarp {
namespace {
using scene_checks::ball_image;
using scene_checks::euler_number;
using scene_checks::is_manifold;

void expect_closed(const Surface& surface, std::int64_t euler) {
  EXPECT_TRUE(is_manifold(surface));
  EXPECT_EQ(euler_number(surface), euler);
  EXPECT_NO_THROW(check_areas("surface", surface));
  EXPECT_NO_THROW(check_closed("surface", surface));
}

TEST(Isosurface, OfABallHasItsVolumeToSecondOrder) {
  const auto error_of = [](double radius) {
    const auto n = static_cast<std::int64_t>(2 * radius) + 5;
    const Surface surface = make_isosurface("volume", ball_image({n, n, n}, radius));
    expect_closed(surface, 2);
    return 1 - volume_of(surface) / (4 * std::numbers::pi / 3 * std::pow(radius, 3));
  };

  const double coarse = error_of(7.3), middle = error_of(14.6), fine = error_of(29.2);

  EXPECT_LT(std::abs(coarse), 0.02);
  EXPECT_NEAR(coarse / middle, 4, 1);
  EXPECT_NEAR(middle / fine, 4, 1);
}

TEST(Isosurface, IsClosedWhereTheForegroundReachesTheBorder) {
  const Surface ball = make_isosurface("volume", ball_image({8, 20, 20}, 6));
  ImageGeometry full{make_volume({{4, 3, 2}}, PixelType::uint8), 0};

  const Surface box = make_isosurface("volume", full);

  expect_closed(ball, 2);
  expect_closed(box, 2);
  const Bounds bounds = bounds_of(box.points);
  EXPECT_NEAR(bounds.low[0], -0.5, 1e-9);
  EXPECT_NEAR(bounds.high[0], 3.5, 1e-9);
  EXPECT_NEAR(bounds.high[2], 1.5, 1e-9);
}

TEST(Isosurface, OfOneVoxelIsClosed) {
  ImageGeometry image{make_volume({{5, 4, 3}}, PixelType::float32), 0.5};
  image.volume.samples<float>()[33] = 1;

  expect_closed(make_isosurface("volume", image), 2);

  image.volume = make_volume({{1, 1, 1}}, PixelType::float32);
  image.volume.samples<float>()[0] = 1;
  expect_closed(make_isosurface("volume", image), 2);
}

/// Samples that equal the threshold are foreground and leave no triangle without area.
TEST(Isosurface, KeepsAwayFromVoxelsThatEqualTheThreshold) {
  ImageGeometry image{make_volume({{6, 6, 6}}, PixelType::uint8), 1};
  for (const std::size_t voxel : {86u, 87u, 92u, 93u, 122u, 128u}) {
    image.volume.samples<std::uint8_t>()[voxel] = 1;
  }

  expect_closed(make_isosurface("volume", image), 2);
}

TEST(Isosurface, IsOutwardsOnMirroredGrids) {
  ImageGeometry image = ball_image({12, 12, 12}, 4);
  image.volume.grid.direction = {0, 1, 0, 1, 0, 0, 0, 0, 1};
  image.volume.grid.spacing = {0.5, 2, 1};

  expect_closed(make_isosurface("volume", image), 2);
}

TEST(Isosurface, HasAboutAsManyTrianglesAsAsked) {
  const ImageGeometry image = ball_image({40, 40, 40}, 17);
  for (const double triangles : {300.0, 1000.0, 3000.0}) {
    const Surface surface = make_isosurface("volume", image, static_cast<std::int64_t>(triangles));

    expect_closed(surface, 2);
    EXPECT_NEAR(static_cast<double>(surface.triangles.size()) / triangles, 1, 0.15);
    for (const Point3& x : surface.points) {
      ASSERT_NEAR(norm(minus(x, {19.5, 19.5, 19.5})), 17, 0.12);
    }
  }
}

TEST(Isosurface, ThresholdAboveTheLargestSampleIsAnError) {
  ImageGeometry image = ball_image({8, 8, 8}, 3);
  image.threshold = 100;

  const std::string message = test::message_of([&] { make_isosurface("bodies[0].volume", image); });

  EXPECT_NE(message.find("bodies[0].volume.threshold: no sample of"), std::string::npos);
}
}  // namespace
}  // namespace tetwarp

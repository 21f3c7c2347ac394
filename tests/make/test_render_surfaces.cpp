/// @file test_render_surfaces.cpp
/// Pictures of surfaces: what is seen where, shadows, arguments.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tetwarp/make.hpp>
#include <vector>

namespace tetwarp {
namespace {
using Triangles = std::vector<std::array<std::int32_t, 3>>;

/// A square in the plane y, of edge 2 half, around the line x = z = 0.
struct Square {
  explicit Square(double y, double half = 0.5)
      : points{{-half, y, -half}, {half, y, -half}, {half, y, half}, {-half, y, half}} {}

  std::vector<Point3> points;
  Triangles triangles{{0, 1, 2}, {0, 2, 3}};
};

constexpr std::array<double, 3> red{0.9, 0.1, 0.1}, blue{0.1, 0.1, 0.9};
const SurfaceRenderOptions front{{{0, -4, 0}, {0, 0, 0}, {0, 0, 1}, 0.6}, 61, 41};

std::array<int, 3> pixel_of(const Image& image, int x, int y) {
  const std::size_t at = 3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                              static_cast<std::size_t>(x));
  return {image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
}
bool is_red(const std::array<int, 3>& rgb) {
  return rgb[0] > 2 * rgb[2];
}
bool is_blue(const std::array<int, 3>& rgb) {
  return rgb[2] > 2 * rgb[0];
}

/// The square spans 0.5 / (4 tan 0.3) of half the height: 8.3 of 20.5 pixels to each side.
TEST(RenderSurfaces, DrawsASurfaceAtItsPlaceInPerspective) {
  const Square square(0);
  const std::vector<DrawnSurface> surfaces{{square.points, square.triangles, red}};

  const Image image = render_surfaces(surfaces, {}, front);

  for (const int offset : {-7, 0, 7}) {
    EXPECT_TRUE(is_red(pixel_of(image, 30 + offset, 20)));
    EXPECT_TRUE(is_red(pixel_of(image, 30, 20 + offset)));
  }
  for (const int offset : {-10, 10}) {
    EXPECT_FALSE(is_red(pixel_of(image, 30 + offset, 20)));
    EXPECT_FALSE(is_red(pixel_of(image, 30, 20 + offset)));
  }
}

TEST(RenderSurfaces, ShowsTheNearerOfTwoSurfaces) {
  const Square near(-1, 0.3), far(1, 1);
  const std::vector<DrawnSurface> one{{near.points, near.triangles, red},
                                      {far.points, far.triangles, blue}};
  const std::vector<DrawnSurface> other{one[1], one[0]};

  for (const auto& surfaces : {one, other}) {
    const Image image = render_surfaces(surfaces, {}, front);
    EXPECT_TRUE(is_red(pixel_of(image, 30, 20)));
    EXPECT_TRUE(is_blue(pixel_of(image, 40, 20)));
  }
}

TEST(RenderSurfaces, DarkensAPlaneInTheShadowOfABody) {
  std::vector<Point3> points{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
  const Triangles triangles{{0, 1, 2}, {0, 2, 3}};
  const std::vector<DrawnSurface> surfaces{{points, triangles, red}};
  const std::vector<DrawnPlane> planes{{{0, 0, 0}, {0, 0, 1}}};
  const SurfaceRenderOptions options{{{0, -12, 6}, {0, 0, 0}, {0, 0, 1}, 0.6}, 120, 80};

  const Image with = render_surfaces(surfaces, planes, options);
  const Image without = render_surfaces({}, planes, options);

  int darker = 0, lighter = 0;
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      if (is_red(pixel_of(with, x, y))) continue;
      const int change = pixel_of(with, x, y)[1] - pixel_of(without, x, y)[1];
      darker += change < -15 ? 1 : 0;
      lighter += change > 40 ? 1 : 0;
    }
  }
  EXPECT_GT(darker, 100);
  EXPECT_LT(darker, 120 * 80 / 2);
}

TEST(RenderSurfaces, ShowsPlanesFromTheSideOfTheirNormalOnly) {
  const std::vector<DrawnPlane> up{{{0, 0, -1}, {0, 0, 2}}}, down{{{0, 0, -1}, {0, 0, -1}}};

  const Image empty = render_surfaces({}, {}, front);

  EXPECT_NE(render_surfaces({}, up, front).rgb, empty.rgb);
  EXPECT_EQ(render_surfaces({}, down, front).rgb, empty.rgb);
}

TEST(RenderSurfaces, RepeatsItsBytes) {
  const Square square(0);
  const std::vector<DrawnSurface> surfaces{{square.points, square.triangles, red}};
  const std::vector<DrawnPlane> planes{{{0, 0, -0.6}, {0, 0, 1}}};

  EXPECT_EQ(render_surfaces(surfaces, planes, front).rgb,
            render_surfaces(surfaces, planes, front).rgb);
}

TEST(RenderSurfaces, DrawsNothingBehindTheEye) {
  const Square square(-5);
  const std::vector<DrawnSurface> surfaces{{square.points, square.triangles, red}};

  const Image image = render_surfaces(surfaces, {}, front);

  EXPECT_EQ(image.rgb, render_surfaces({}, {}, front).rgb);
}

TEST(CameraOf, ShowsAllPoints) {
  const std::vector<Point3> points{{0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 2},
                                   {3, 1, 0}, {3, 0, 2}, {0, 1, 2}, {3, 1, 2}};
  Triangles triangles;
  for (std::int32_t a = 0; a < 8; ++a) {
    for (std::int32_t b = 0; b < a; ++b) triangles.push_back({a, b, 7 - a});
  }
  const std::vector<DrawnSurface> surfaces{{points, triangles, red}};
  for (const std::array<int, 2> size : {std::array{90, 60}, std::array{40, 100}}) {
    const SurfaceRenderOptions options{camera_of(points, static_cast<double>(size[0]) / size[1]),
                                       size[0], size[1]};

    const Image image = render_surfaces(surfaces, {}, options);

    EXPECT_TRUE(is_red(pixel_of(image, size[0] / 2, size[1] / 2)));
    for (int x = 0; x < size[0]; ++x) {
      EXPECT_FALSE(is_red(pixel_of(image, x, 0)));
      EXPECT_FALSE(is_red(pixel_of(image, x, size[1] - 1)));
    }
    for (int y = 0; y < size[1]; ++y) {
      EXPECT_FALSE(is_red(pixel_of(image, 0, y)));
      EXPECT_FALSE(is_red(pixel_of(image, size[0] - 1, y)));
    }
  }
}

TEST(RenderSurfaces, RefusesBadArguments) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Square bad_index(0), bad_point(0);
  bad_index.triangles[1][2] = 4;
  bad_point.points[0][1] = nan;
  for (const Square& square : {bad_index, bad_point}) {
    const std::vector<DrawnSurface> surfaces{{square.points, square.triangles, red}};
    EXPECT_THROW(render_surfaces(surfaces, {}, front), std::invalid_argument);
  }
  SurfaceRenderOptions no_size = front, same_point = front, along_up = front;
  no_size.width = 0;
  same_point.camera.eye = same_point.camera.target;
  along_up.camera.up = {0, 1, 0};
  for (const SurfaceRenderOptions& options : {no_size, same_point, along_up}) {
    EXPECT_THROW(render_surfaces({}, {}, options), std::invalid_argument);
  }
  const std::vector<DrawnPlane> flat{{{0, 0, 0}, {0, 0, 0}}};
  EXPECT_THROW(render_surfaces({}, flat, front), std::invalid_argument);
  EXPECT_THROW(camera_of(bad_point.points, 1), std::invalid_argument);
  EXPECT_THROW(camera_of({}, 0), std::invalid_argument);
}
}  // namespace
}  // namespace tetwarp

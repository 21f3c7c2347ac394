/// @file surface_picture.hpp
/// SurfacePicture: light and depth at each sample of a picture of surfaces.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/make.hpp>

#include "host/base/parallel.hpp"
#include "host/make/picture_view.hpp"
#include "host/make/surface_soup.hpp"
#include "host/make/triangle_raster.hpp"

namespace tetwarp {

using Light = std::array<double, 3>;  ///< red, green, blue in proportion to light, 0 to 1

inline constexpr int picture_samples = 2;  ///< per pixel along each axis

/// The light of a sample, and how far away what it shows is: eye + depth * view().ray() [world].
struct SurfaceSample {
  Light light{};
  double depth = 0;  ///< infinite where it shows the background
};

using PixelSamples = std::array<SurfaceSample, picture_samples * picture_samples>;

/// A checker board on a plane.
struct Board {
  Point3 point, normal, u, v;
  double cell = 1;  ///< edge of a square
};

/// A depth buffer of surfaces, with what their light needs.
class SurfacePicture {
 public:
  /// @throws std::invalid_argument  as render_surfaces()
  SurfacePicture(std::span<const DrawnSurface> surfaces,
                 std::span<const DrawnPlane> planes,
                 const SurfaceRenderOptions& options);

  /// The camera of samples, `picture_samples` per pixel along each axis.
  const PictureView& view() const { return view_; }
  SurfaceSample at(int x, int y) const;
  /// All samples of a pixel.
  PixelSamples of_pixel(int x, int y) const;

 private:
  Light background(int y) const;
  Light shade(const Board& board, const Point3& world) const;
  Light shade(std::int32_t triangle, int x, int y, const Point3& ray, double depth) const;

  SurfaceSoup soup_;
  PictureView view_;
  Point3 up_, target_;
  double extent_;  ///< height of what the picture shows at the target: pictures of a film share it
  Point3 light_, fill_;
  ShadowMap shadow_;
  std::vector<Light> colors_;
  std::vector<Board> boards_;
  std::vector<PicturePoint> points_;
  DepthBuffer buffer_;
};

/// sRGB of the mean light of a pixel, 0 to 1.
std::array<double, 3> srgb_of(const PixelSamples& samples);

/// @throws std::invalid_argument  when a picture of this size cannot be drawn
void check_picture_size(const SurfaceRenderOptions& options);

/// Draws a picture on all threads.
/// @param srgb_at  (int x, int y) -> sRGB of a pixel, 0 to 1
template <class SrgbAt>
Image draw_picture(int width, int height, const SrgbAt& srgb_at) {
  Image image{width, height, {}};
  const auto row = 3 * static_cast<std::size_t>(width);
  image.rgb.resize(row * static_cast<std::size_t>(height));
  parallel_for(thread_count(0), height, [&](std::int64_t y) {
    std::uint8_t* pixel = image.rgb.data() + static_cast<std::size_t>(y) * row;
    for (int x = 0; x < width; ++x) {
      for (const double level : srgb_at(x, static_cast<int>(y))) {
        *pixel++ = static_cast<std::uint8_t>(std::lround(255 * level));
      }
    }
  });
  return image;
}

}  // namespace tetwarp

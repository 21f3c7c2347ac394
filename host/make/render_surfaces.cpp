/// @file render_surfaces.cpp
/// Pictures of surfaces, and of volumes among them.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <tetwarp/cast.hpp>
#include <tetwarp/make.hpp>
#include <vector>

#include "host/make/surface_picture.hpp"
#include "host/make/volume_rays.hpp"

namespace tetwarp {

Image render_surfaces(std::span<const DrawnSurface> surfaces,
                      std::span<const DrawnPlane> planes,
                      const SurfaceRenderOptions& options) {
  check_picture_size(options);
  const SurfacePicture picture(surfaces, planes, options);
  return draw_picture(options.width, options.height,
                      [&](int x, int y) { return srgb_of(picture.of_pixel(x, y)); });
}

Image cast_volumes(std::span<const CastVolume> volumes,
                   std::span<const DrawnSurface> surfaces,
                   std::span<const DrawnPlane> planes,
                   const SurfaceRenderOptions& options,
                   double step) {
  check_picture_size(options);
  const VolumeRays rays(volumes, step);
  const SurfacePicture picture(surfaces, planes, options);
  return draw_picture(options.width, options.height, [&](int x, int y) {
    const PixelSamples samples = picture.of_pixel(x, y);
    constexpr double middle = 0.5 * picture_samples;
    const Point3 ray =
        picture.view().ray(picture_samples * x + middle, picture_samples * y + middle);
    std::array<double, samples.size()> depths{};
    std::ranges::transform(samples, depths.begin(), &SurfaceSample::depth);
    const RayColor volume = rays.cast(picture.view().eye, ray, depths);
    std::array<double, 3> srgb = srgb_of(samples);
    for (std::size_t c = 0; c < 3; ++c) {
      srgb[c] = std::clamp(volume.color[c] + volume.clear * srgb[c], 0.0, 1.0);
    }
    return srgb;
  });
}

}  // namespace tetwarp

/// @file image_samples.hpp
/// Images of which the foreground is known.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <tetwarp/scene.hpp>

namespace tetwarp::scene_checks {

/// A ball around the middle of the grid; samples: radius minus the distance from the middle
/// [voxel], threshold 0.
inline ImageGeometry ball_image(const std::array<std::int64_t, 3>& dims, double radius) {
  ImageGeometry image{make_volume({dims}, PixelType::float32), 0};
  const auto samples = image.volume.samples<float>();
  std::size_t v = 0;
  for (std::int64_t k = 0; k < dims[2]; ++k) {
    for (std::int64_t j = 0; j < dims[1]; ++j) {
      for (std::int64_t i = 0; i < dims[0]; ++i) {
        const double x = static_cast<double>(i) - 0.5 * static_cast<double>(dims[0] - 1);
        const double y = static_cast<double>(j) - 0.5 * static_cast<double>(dims[1] - 1);
        const double z = static_cast<double>(k) - 0.5 * static_cast<double>(dims[2] - 1);
        samples[v++] = static_cast<float>(radius - std::hypot(x, y, z));
      }
    }
  }
  return image;
}

}  // namespace tetwarp::scene_checks

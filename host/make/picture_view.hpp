/// @file picture_view.hpp
/// Cameras of pictures of surfaces, and shadow maps of their light.
#pragma once
#include <vector>

#include <tetwarp/make.hpp>

#include "host/make/surface_soup.hpp"
#include "host/make/triangle_raster.hpp"

namespace tetwarp {

/// A camera with its axes: `right`, `down` and `forward` are unit vectors at right angles.
class PictureView {
 public:
  /// @throws std::invalid_argument on a camera that shows nothing
  PictureView(const Camera& camera, int width, int height);

  /// Nearness is 1 / depth.
  PicturePoint project(const Point3& world) const;
  /// Direction through a sample; its part along `forward` is 1.
  Point3 ray(double x, double y) const;

  Point3 eye, right, down, forward;

 private:
  double half_width_, half_height_;  ///< of the picture [sample]
  double scale_;                     ///< samples per unit of x / depth
  double nearest_;                   ///< depth in front of which nothing is drawn
};

/// Which points of a scene the light of a direction reaches.
class ShadowMap {
 public:
  /// @param light  unit vector towards the light
  ShadowMap(const SurfaceSoup& soup, const Point3& light);

  /// Share of the light that reaches a point, 0 to 1; a smooth edge of a few samples.
  double light_at(const Point3& world, const Point3& normal) const;

 private:
  PicturePoint project(const Point3& world) const;

  Point3 light_, right_, down_, center_;
  double scale_ = 0;  ///< samples per unit of length
  DepthBuffer buffer_;
};

}  // namespace tetwarp

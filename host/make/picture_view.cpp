/// @file picture_view.cpp
/// Projections of the camera and of the light.
#include "host/make/picture_view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
using std::numbers::pi;
constexpr int shadow_samples = 1536;

}  // namespace

PictureView::PictureView(const Camera& camera, int width, int height)
    : eye(camera.eye), half_width_(0.5 * width), half_height_(0.5 * height) {
  const Point3 line = minus(camera.target, camera.eye);
  const double distance = norm(line);
  forward = unit(line);
  const Point3 side = cross(forward, camera.up);
  const bool is_sound = is_finite(camera.eye) && is_finite(camera.target) && is_finite(camera.up) &&
                        distance > 0 && std::isfinite(distance) &&
                        norm(side) > 1e-9 * norm(camera.up) && camera.angle > 0 &&
                        camera.angle < pi;
  if (!is_sound) {
    throw std::invalid_argument(
        "render_surfaces: the camera needs a finite eye and target that differ, an up vector that "
        "is not along their line, and an angle between 0 and pi");
  }
  right = unit(side);
  down = cross(forward, right);
  scale_ = half_height_ / std::tan(0.5 * camera.angle);
  nearest_ = 1e-3 * distance;
}

PicturePoint PictureView::project(const Point3& world) const {
  const Point3 offset = minus(world, eye);
  const double depth = dot(offset, forward);
  if (!(depth > nearest_)) return {0, 0, 0, false};
  return {half_width_ + scale_ * dot(offset, right) / depth,
          half_height_ + scale_ * dot(offset, down) / depth, 1 / depth, true};
}

Point3 PictureView::ray(double x, double y) const {
  return plus(forward, plus(times((x - half_width_) / scale_, right),
                            times((y - half_height_) / scale_, down)));
}

ShadowMap::ShadowMap(const SurfaceSoup& soup, const Point3& light) : light_(light) {
  right_ = unit(cross(light, std::abs(light[0]) < 0.9 ? Point3{1, 0, 0} : Point3{0, 1, 0}));
  down_ = cross(light_, right_);
  center_ = times(0.5, plus(soup.low, soup.high));
  const double radius = 0.5 * norm(minus(soup.high, soup.low));
  scale_ = radius > 0 ? 0.5 * shadow_samples / (1.02 * radius) : 1;
  std::vector<PicturePoint> points;
  points.reserve(soup.points.size());
  for (const Point3& point : soup.points) points.push_back(project(point));
  buffer_ = draw_triangles(points, soup.triangles, shadow_samples, shadow_samples);
}

PicturePoint ShadowMap::project(const Point3& world) const {
  const Point3 offset = minus(world, center_);
  return {0.5 * shadow_samples + scale_ * dot(offset, right_),
          0.5 * shadow_samples + scale_ * dot(offset, down_), scale_ * dot(offset, light_), true};
}

double ShadowMap::light_at(const Point3& world, const Point3& normal) const {
  constexpr int reach = 3;      // samples of the edge to each side
  constexpr double offset = 3;  // along the normal, against shadows of a triangle on itself
  const PicturePoint point = project(plus(world, times(offset / scale_, normal)));
  if (!(std::abs(point.x) < 2 * shadow_samples && std::abs(point.y) < 2 * shadow_samples)) return 1;
  const int x0 = static_cast<int>(std::floor(point.x));
  const int y0 = static_cast<int>(std::floor(point.y));
  double lit = 0, all = 0;
  for (int y = y0 - reach; y <= y0 + reach; ++y) {
    for (int x = x0 - reach; x <= x0 + reach; ++x) {
      const double dx = x + 0.5 - point.x, dy = y + 0.5 - point.y;
      const double weight = std::max(0.0, (reach + 0.5) * (reach + 0.5) - dx * dx - dy * dy);
      const bool is_inside = x >= 0 && y >= 0 && x < buffer_.width && y < buffer_.height;
      const bool is_dark = is_inside && buffer_.nearness[buffer_.at(x, y)] > point.nearness + 2;
      all += weight;
      if (!is_dark) lit += weight;
    }
  }
  return lit / all;
}

Camera camera_of(std::span<const Point3> points, double aspect) {
  if (!std::ranges::all_of(points, is_finite) || !(aspect > 0) || !std::isfinite(aspect)) {
    throw std::invalid_argument("camera_of: a point is not finite or the aspect is not above 0");
  }
  Point3 low{-1, -1, -1}, high{1, 1, 1};
  if (!points.empty()) low = high = points.front();
  for (const Point3& point : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], point[axis]);
      high[axis] = std::max(high[axis], point[axis]);
    }
  }
  constexpr double filled = 0.85;  // of width or height
  Camera camera;
  camera.target = times(0.5, plus(low, high));
  const Point3 back = unit({0.55, -1, 0.5});
  const Point3 right = unit(cross(camera.up, back));
  const Point3 up = cross(back, right);
  const double slope = filled * std::tan(0.5 * camera.angle);
  double distance = 0;
  const auto include = [&](const Point3& point) {
    const Point3 offset = minus(point, camera.target);
    const double across =
        std::max(std::abs(dot(offset, right)) / aspect, std::abs(dot(offset, up)));
    distance = std::max(distance, across / slope + dot(offset, back));
  };
  std::ranges::for_each(points, include);
  if (points.empty()) distance = 2 / slope;
  if (!(distance > 0)) distance = 1;
  camera.eye = plus(camera.target, times(distance, back));
  return camera;
}

}  // namespace tetwarp

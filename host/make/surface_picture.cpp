/// @file surface_picture.cpp
/// A depth buffer, then light and shadow of the samples.
#include "host/make/surface_picture.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "host/base/point3.hpp"

namespace tetwarp {
namespace {
constexpr int largest_edge = 4096;  // of a picture [pixel]

double linear_of(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}
double srgb_of(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}
Light mixed(const Light& a, const Light& b, double share) {
  return {std::lerp(a[0], b[0], share), std::lerp(a[1], b[1], share), std::lerp(a[2], b[2], share)};
}

/// 1, 2 or 5 times a power of ten, near `size`.
double round_number(double size) {
  if (!(size > 0)) return 1;
  const double power = std::pow(10, std::floor(std::log10(size)));
  const double lead = size / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

Board board_of(const DrawnPlane& plane, double extent) {
  const Point3 normal = unit(plane.normal);
  if (!(std::abs(norm(normal) - 1) < 1e-9) || !std::isfinite(dot(plane.point, normal))) {
    throw std::invalid_argument("render_surfaces: a plane needs a finite point and a normal");
  }
  const Point3 aside = std::abs(normal[0]) < 0.9 ? Point3{1, 0, 0} : Point3{0, 1, 0};
  const Point3 u = unit(minus(aside, times(dot(aside, normal), normal)));
  return {plane.point, normal, u, cross(normal, u), round_number(extent / 5)};
}

double height_at_target(const Camera& camera) {
  return 2 * std::tan(0.5 * camera.angle) * norm(minus(camera.target, camera.eye));
}
}  // namespace

SurfacePicture::SurfacePicture(std::span<const DrawnSurface> surfaces,
                               std::span<const DrawnPlane> planes,
                               const SurfaceRenderOptions& options)
    : soup_(make_soup(surfaces)),
      view_(options.camera, picture_samples * options.width, picture_samples * options.height),
      up_(unit(options.camera.up)),
      target_(options.camera.target),
      extent_(height_at_target(options.camera)),
      light_(
          unit(plus(times(1.1, up_), plus(times(-0.5, view_.forward), times(-0.55, view_.right))))),
      fill_(unit(plus(times(0.1, up_), plus(times(-1, view_.forward), times(0.8, view_.right))))),
      shadow_(soup_, light_) {
  for (const DrawnSurface& surface : surfaces) {
    colors_.push_back(
        {linear_of(surface.color[0]), linear_of(surface.color[1]), linear_of(surface.color[2])});
  }
  for (const DrawnPlane& plane : planes) boards_.push_back(board_of(plane, extent_));
  points_.reserve(soup_.points.size());
  for (const Point3& point : soup_.points) points_.push_back(view_.project(point));
  buffer_ = draw_triangles(points_, soup_.triangles, picture_samples * options.width,
                           picture_samples * options.height);
}

SurfaceSample SurfacePicture::at(int x, int y) const {
  const Point3 ray = view_.ray(x + 0.5, y + 0.5);
  const std::size_t at = buffer_.at(x, y);
  const std::int32_t triangle = buffer_.triangle[at];
  double depth = triangle < 0 ? INFINITY : 1 / static_cast<double>(buffer_.nearness[at]);
  Light color = background(y);
  if (triangle >= 0) color = shade(triangle, x, y, ray, depth);
  for (const Board& board : boards_) {
    const double along = dot(ray, board.normal);
    const double distance = dot(minus(board.point, view_.eye), board.normal) / along;
    if (!(along < 0) || !(distance > 0) || !(distance < depth)) continue;
    const Point3 world = plus(view_.eye, times(distance, ray));
    const double far = norm(minus(world, target_)) / extent_;
    const double fade = std::clamp((far - 1.2) / 2.6, 0.0, 1.0);
    if (fade >= 1) continue;
    color = mixed(shade(board, world), background(y), fade * fade * (3 - 2 * fade));
    depth = distance;
  }
  return {color, depth};
}

Light SurfacePicture::background(int y) const {
  return mixed({0.80, 0.86, 0.93}, {0.98, 0.98, 0.98}, (y + 0.5) / buffer_.height);
}

Light SurfacePicture::shade(const Board& board, const Point3& world) const {
  const Point3 offset = minus(world, board.point);
  const auto column = std::floor(dot(offset, board.u) / board.cell);
  const auto row = std::floor(dot(offset, board.v) / board.cell);
  const bool is_dark = std::fmod(std::abs(column + row), 2) == 1;
  const double gray = is_dark ? 0.50 : 0.66;
  const double lit = shadow_.light_at(world, board.normal);
  const double light = 0.50 + 0.62 * std::max(0.0, dot(board.normal, light_)) * lit;
  return {gray * light, gray * light, gray * light * 1.03};
}

Light SurfacePicture::shade(
    std::int32_t triangle, int x, int y, const Point3& ray, double depth) const {
  const auto t = static_cast<std::size_t>(triangle);
  std::array<PicturePoint, 3> corners;
  for (std::size_t c = 0; c < 3; ++c) {
    corners[c] = points_[static_cast<std::size_t>(soup_.triangles[t][c])];
  }
  std::array<double, 3> weights{};
  corner_weights(corners, x + 0.5, y + 0.5, weights);
  Point3 normal{0, 0, 0};
  for (std::size_t c = 0; c < 3; ++c) {
    normal = plus(normal, times(weights[c] * corners[c].nearness * depth, soup_.normals[t][c]));
  }
  normal = unit(normal);
  const Point3 toward = unit(times(-1, ray));
  if (dot(normal, toward) < 0) normal = times(-1, normal);
  const Point3 world = plus(view_.eye, times(depth, ray));
  const double facing = std::max(0.0, dot(normal, light_));
  const double lit = facing > 0 ? shadow_.light_at(world, normal) : 0;
  const double sky = 0.5 + 0.5 * dot(normal, up_);
  const double light =
      0.24 + 0.22 * sky + 0.78 * facing * lit + 0.26 * std::max(0.0, dot(normal, fill_));
  const double shine = std::pow(std::max(0.0, dot(normal, unit(plus(light_, toward)))), 48);
  const double rim = std::pow(1 - std::max(0.0, dot(normal, toward)), 3);
  const Light& base = colors_[static_cast<std::size_t>(soup_.surface[t])];
  Light color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = base[c] * light * (1 - 0.25 * rim) + 0.16 * shine * lit + 0.03 * rim;
  }
  return color;
}

PixelSamples SurfacePicture::of_pixel(int x, int y) const {
  PixelSamples all;
  for (int s = 0; s < picture_samples * picture_samples; ++s) {
    all[static_cast<std::size_t>(s)] =
        at(picture_samples * x + s % picture_samples, picture_samples * y + s / picture_samples);
  }
  return all;
}

std::array<double, 3> srgb_of(const PixelSamples& samples) {
  Light sum{};
  for (const SurfaceSample& sample : samples) {
    for (std::size_t c = 0; c < 3; ++c) sum[c] += std::clamp(sample.light[c], 0.0, 1.0);
  }
  constexpr double count = picture_samples * picture_samples;
  return {srgb_of(sum[0] / count), srgb_of(sum[1] / count), srgb_of(sum[2] / count)};
}

void check_picture_size(const SurfaceRenderOptions& options) {
  const bool is_sized = options.width > 0 && options.height > 0 && options.width <= largest_edge &&
                        options.height <= largest_edge;
  if (is_sized) return;
  throw std::invalid_argument("render_surfaces: a picture of " + std::to_string(options.width) +
                              " x " + std::to_string(options.height) + " pixels, expected 1 to " +
                              std::to_string(largest_edge) + " each way");
}

}  // namespace tetwarp

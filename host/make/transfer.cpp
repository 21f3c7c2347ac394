/// @file transfer.cpp
/// Presets, transfer functions, and linear interpolation of samples.
#include "host/make/transfer.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/base/index_space.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/make/shown_value.hpp"

namespace tetwarp {
namespace {
using Points = std::vector<ColorPoint>;

// Values are Hounsfield units.
const Points hounsfield_points{{-1000, {0, 0, 0}, 0},           {-250, {0.3, 0.15, 0.1}, 0},
                               {-80, {0.85, 0.65, 0.45}, 0.02}, {40, {0.80, 0.35, 0.28}, 0.06},
                               {130, {0.85, 0.40, 0.30}, 0.15}, {250, {0.95, 0.85, 0.70}, 0.5},
                               {1000, {1, 0.98, 0.94}, 0.9}};
// Values are fractions of the range.
const Points tomography_points{{0, {0, 0, 0}, 0},
                               {0.12, {0.3, 0.15, 0.1}, 0},
                               {0.3, {0.85, 0.65, 0.45}, 0.03},
                               {0.5, {0.80, 0.35, 0.28}, 0.08},
                               {0.65, {0.9, 0.6, 0.45}, 0.25},
                               {0.8, {0.95, 0.88, 0.74}, 0.6},
                               {1, {1, 0.98, 0.94}, 0.9}};
const Points resonance_points{{0, {0, 0, 0}, 0},
                              {0.12, {0.1, 0.1, 0.1}, 0},
                              {0.4, {0.5, 0.5, 0.5}, 0.06},
                              {0.7, {0.8, 0.8, 0.8}, 0.3},
                              {1, {1, 1, 1}, 0.8}};

[[noreturn]] void refuse(const std::string& problem) {
  throw std::invalid_argument("transfer function: " + problem);
}

/// Color and opacity of a value.
ColorPoint point_at(const Points& points, double value) {
  std::size_t p = 0;
  while (p < points.size() && points[p].value < value) ++p;  // none for NaN
  if (p == 0) return points.front();
  if (p == points.size()) return points.back();
  const ColorPoint &a = points[p - 1], &b = points[p];
  const double share = (value - a.value) / (b.value - a.value);
  ColorPoint point{value, {}, std::lerp(a.opacity, b.opacity, share)};
  for (std::size_t c = 0; c < 3; ++c) point.color[c] = std::lerp(a.color[c], b.color[c], share);
  return point;
}

template <class T>
double interpolated(const Volume& volume, const Point3& index) {
  std::array<std::int64_t, 3> low{}, step{};
  std::array<double, 3> share{};
  std::int64_t stride = volume.components;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t last = volume.grid.dims[axis] - 1;
    const double place = std::clamp(index[axis], 0.0, static_cast<double>(last));
    const auto below = static_cast<std::int64_t>(place);
    share[axis] = place - static_cast<double>(below);
    low[axis] = below * stride;
    step[axis] = below < last ? stride : 0;
    stride *= volume.grid.dims[axis];
  }
  const T* const base = volume.samples<T>().data() + low[0] + low[1] + low[2];
  const auto along_i = [&](const T* sample) {
    const double a = shown_value(sample, volume.components);
    if (share[0] == 0) return a;
    return std::lerp(a, shown_value(sample + step[0], volume.components), share[0]);
  };
  const auto along_j = [&](const T* sample) {
    const double a = along_i(sample);
    return share[1] == 0 ? a : std::lerp(a, along_i(sample + step[1]), share[1]);
  };
  const double a = along_j(base);
  return share[2] == 0 ? a : std::lerp(a, along_j(base + step[2]), share[2]);
}
}  // namespace

std::vector<ColorPoint> preset_colors(const std::string& preset, double low, double high) {
  if (preset != "ct" && preset != "mr") {
    throw std::invalid_argument("preset '" + preset + "', expected ct or mr");
  }
  if (preset == "ct" && low < -500 && high > 300) return hounsfield_points;
  Points points = preset == "ct" ? tomography_points : resonance_points;
  for (ColorPoint& point : points) point.value = std::lerp(low, high, point.value);
  return points;
}

double preset_length(const Grid& grid) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = static_cast<double>(grid.dims[axis]) * step_length(grid, axis);
    sum += length * length;
  }
  return std::sqrt(sum) / 200;
}

std::array<double, 2> finite_range(const Volume& volume) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  with_pixel_type(volume.type, [&]<class T>(T) {
    const T* const samples = volume.samples<T>().data();
    for (std::int64_t v = 0; v < volume.grid.voxel_count(); ++v) {
      const double value = shown_value(samples + v * volume.components, volume.components);
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
  });
  return low <= high ? std::array{low, high} : std::array{0.0, 1.0};
}

void check_transfer(const TransferFunction& function) {
  if (!(function.unit_length > 0 && std::isfinite(function.unit_length))) {
    refuse("the length of the opacities is not a number above 0");
  }
  if (function.points.empty()) refuse("has no points");
  const auto is_share = [](double number) { return number >= 0 && number <= 1; };
  for (std::size_t p = 0; p < function.points.size(); ++p) {
    const ColorPoint& point = function.points[p];
    const std::string name = "point " + std::to_string(p);
    if (!std::isfinite(point.value)) refuse("the value of " + name + " is not finite");
    if (p > 0 && !(function.points[p - 1].value <= point.value)) {
      refuse("the value of " + name + " is below that of the one before");
    }
    if (!is_share(point.opacity) || !std::ranges::all_of(point.color, is_share)) {
      refuse("color and opacity of " + name + " are not all from 0 to 1");
    }
  }
}

Matter matter_of(const TransferFunction& function, double value) {
  const ColorPoint point = point_at(function.points, value);
  if (point.opacity <= 0) return {};
  return {point.color, -std::log1p(-point.opacity) / function.unit_length};
}

bool is_clear(const TransferFunction& function, double low, double high) {
  const Points& points = function.points;
  return point_at(points, low).opacity <= 0 && point_at(points, high).opacity <= 0 &&
         std::ranges::none_of(points, [&](const ColorPoint& point) {
           return point.value >= low && point.value <= high && point.opacity > 0;
         });
}

double value_at(const Volume& volume, std::int64_t voxel) {
  double value = 0;
  with_pixel_type(volume.type, [&]<class T>(T) {
    value = shown_value(volume.samples<T>().data() + voxel * volume.components, volume.components);
  });
  return value;
}

double sample_at(const Volume& volume, const Point3& index) {
  double value = 0;
  with_pixel_type(volume.type, [&]<class T>(T) { value = interpolated<T>(volume, index); });
  return value;
}

}  // namespace tetwarp

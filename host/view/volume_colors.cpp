/// @file volume_colors.cpp
/// The presets, moved and stretched.
#include "host/view/volume_colors.hpp"

#include "host/view/live_frame.hpp"

namespace tetwarp::view {

VolumeColors::VolumeColors(const std::string& preset, double low, double high) {
  const double width = high > low ? high - low : 1;
  points_ = preset_colors(preset, low, low + width);
  for (ColorPoint& point : points_) point.value = (point.value - low) / width * largest_sample;
}

std::vector<ColorPoint> VolumeColors::curve() const {
  const double first = points_.front().value, last = points_.back().value;
  std::vector<ColorPoint> curve = points_;
  for (ColorPoint& point : curve) point.value = (point.value - first) / (last - first);
  return curve;
}

void VolumeColors::set_curve(const std::vector<ColorPoint>& curve) {
  const double first = points_.front().value, last = points_.back().value;
  points_ = curve;
  for (ColorPoint& point : points_) point.value = first + (last - first) * point.value;
}

void VolumeColors::set_window(double level, double width) {
  level_ = level;
  width_ = width;
}

double VolumeColors::moved(double sample) const {
  const double first = points_.front().value, last = points_.back().value;
  const double middle = (first + last) / 2;
  return middle + level_ * (last - first) + width_ * (sample - middle);
}

std::vector<ColorPoint> VolumeColors::points() const {
  std::vector<ColorPoint> points = points_;
  for (ColorPoint& point : points) point.value = moved(point.value);
  return points;
}

std::array<double, 2> VolumeColors::gray() const {
  return {moved(points_.front().value), moved(points_.back().value)};
}

}  // namespace tetwarp::view

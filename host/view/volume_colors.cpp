/// @file volume_colors.cpp
/// The presets.
#include "host/view/volume_colors.hpp"

#include "host/view/live_frame.hpp"

namespace tetwarp::view {
namespace {
using Points = std::vector<ColorPoint>;

// Samples are Hounsfield units.
const Points hounsfield_points{{-1000, {0, 0, 0}, 0},           {-250, {0.3, 0.15, 0.1}, 0},
                               {-80, {0.85, 0.65, 0.45}, 0.02}, {40, {0.80, 0.35, 0.28}, 0.06},
                               {130, {0.85, 0.40, 0.30}, 0.15}, {250, {0.95, 0.85, 0.70}, 0.5},
                               {1000, {1, 0.98, 0.94}, 0.9}};
// Samples are fractions of the range.
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
}  // namespace

VolumeColors::VolumeColors(const std::string& preset, double low, double high) {
  const bool is_hounsfield = preset == "ct" && low < -500 && high > 300;
  points_ = is_hounsfield    ? hounsfield_points
            : preset == "ct" ? tomography_points
                             : resonance_points;
  for (ColorPoint& point : points_) {
    const double share = is_hounsfield ? (point.sample - low) / (high - low) : point.sample;
    point.sample = share * largest_sample;
  }
}

Points VolumeColors::curve() const {
  const double first = points_.front().sample, last = points_.back().sample;
  Points curve = points_;
  for (ColorPoint& point : curve) point.sample = (point.sample - first) / (last - first);
  return curve;
}

void VolumeColors::set_curve(const Points& curve) {
  const double first = points_.front().sample, last = points_.back().sample;
  points_ = curve;
  for (ColorPoint& point : points_) point.sample = first + (last - first) * point.sample;
}

void VolumeColors::set_window(double level, double width) {
  level_ = level;
  width_ = width;
}

double VolumeColors::moved(double sample) const {
  const double first = points_.front().sample, last = points_.back().sample;
  const double middle = (first + last) / 2;
  return middle + level_ * (last - first) + width_ * (sample - middle);
}

std::vector<ColorPoint> VolumeColors::points() const {
  Points points = points_;
  for (ColorPoint& point : points) point.sample = moved(point.sample);
  return points;
}

std::array<double, 2> VolumeColors::gray() const {
  return {moved(points_.front().sample), moved(points_.back().sample)};
}

}  // namespace tetwarp::view

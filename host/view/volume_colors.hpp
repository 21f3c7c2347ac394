/// @file volume_colors.hpp
/// VolumeColors: how values of a volume become color and opacity.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace tetwarp::view {

/// A point of a curve that is linear between its points.
struct ColorPoint {
  double sample = 0;  ///< of VolumeFrame::samples
  std::array<double, 3> color{};
  double opacity = 0;  ///< over a two-hundredth of the diagonal of the volume, 0 to 1

  bool operator==(const ColorPoint&) const = default;
};

/// Turning the window moves and stretches the curve.
class VolumeColors {
 public:
  /// @param preset     ct or mr
  /// @param low, high  values of the volume that are sample 0 and the largest one. Computed
  ///                   tomographies, whose air is below -500 and bone above 300, get the usual
  ///                   limits in Hounsfield units; of other volumes the range is divided.
  VolumeColors(const std::string& preset, double low, double high);

  /// The curve with samples as shares: 0 is the first, 1 the last.
  std::vector<ColorPoint> curve() const;
  /// Another curve between the same ends. @param curve  as curve() gives it, with two points or
  /// more
  void set_curve(const std::vector<ColorPoint>& curve);

  /// @param level  by how much the curve moves, in its widths
  /// @param width  factor of its width, > 0
  void set_window(double level, double width);

  std::vector<ColorPoint> points() const;
  /// Samples between which slices go from black to white.
  std::array<double, 2> gray() const;

 private:
  double moved(double sample) const;

  std::vector<ColorPoint> points_;
  double level_ = 0, width_ = 1;
};

}  // namespace tetwarp::view

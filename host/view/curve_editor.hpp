/// @file curve_editor.hpp
/// CurveEditor: points of a curve of color and opacity that the mouse drags.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "host/view/volume_colors.hpp"

namespace tetwarp::view {

/// Places are shares of a panel's width and height, from the lower left: samples to the right,
/// opacities upwards.
class CurveEditor {
 public:
  /// @param curve  as VolumeColors::curve()
  explicit CurveEditor(std::vector<ColorPoint> curve) : curve_(std::move(curve)) {}

  const std::vector<ColorPoint>& curve() const { return curve_; }
  /// The curve once a point has been changed; empty before.
  std::vector<ColorPoint> edited() const;
  /// The point next to a place, if it is near.
  std::optional<std::size_t> hit(double x, double y) const;
  /// Moves a point, not beyond its neighbors; the first and the last stay at their samples.
  void drag(std::size_t point, double x, double y);
  /// Turns the hue of a point and changes its saturation.
  /// @param hue, saturation  by so much; a hue goes from 0 to 1 around the circle of colors
  void tint(std::size_t point, double hue, double saturation);

 private:
  std::vector<ColorPoint> curve_;
  bool is_edited_ = false;
};

}  // namespace tetwarp::view

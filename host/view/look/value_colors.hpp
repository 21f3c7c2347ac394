/// @file value_colors.hpp
/// Colors of values at points of surfaces.
#pragma once
#include <vector>

#include "host/view/look/scene_look.hpp"
#include "host/view/look/surface_values.hpp"

namespace tetwarp::view {

/// From blue over green and yellow to red.
/// @param share  of the range; what is beyond its ends has the color of the end
Rgb value_color(double share);

/// The range of the values of a quantity so far.
class ValueRange {
 public:
  ValueRange() = default;
  ValueRange(double low, double high) : low_(low), high_(high) {}

  /// Starts anew with another quantity. Values that are not finite do not count.
  void include(SurfaceQuantity quantity, const std::vector<std::vector<float>>& values);
  /// Adhesion goes from 0 to 1, stress from 0 on, gaps between their extremes.
  double low() const { return low_; }
  double high() const { return high_; }
  /// Of the range; not a number where the value is none.
  double share(float value) const;

 private:
  SurfaceQuantity quantity_ = SurfaceQuantity::none;
  double low_ = 0, high_ = 0;
  bool has_value_ = false;
};

}  // namespace tetwarp::view

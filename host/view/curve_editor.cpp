/// @file curve_editor.cpp
/// Places of points, and their colors as hue and saturation.
#include "host/view/curve_editor.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetwarp::view {
namespace {
constexpr double reach = 0.06;  // of the panel

/// Hue, saturation and value of red, green and blue, all from 0 to 1.
std::array<double, 3> hsv_of(const std::array<double, 3>& rgb) {
  const auto [red, green, blue] = rgb;
  const double value = std::max({red, green, blue}), chroma = value - std::min({red, green, blue});
  if (chroma <= 0) return {0, 0, value};
  const double sixth = value == red     ? (green - blue) / chroma
                       : value == green ? 2 + (blue - red) / chroma
                                        : 4 + (red - green) / chroma;
  return {(sixth < 0 ? sixth + 6 : sixth) / 6, chroma / value, value};
}

std::array<double, 3> rgb_of(const std::array<double, 3>& hsv) {
  std::array<double, 3> rgb{};
  for (std::size_t c = 0; c < 3; ++c) {
    // 0 near the color's own hue, 1 from a sixth of the circle beyond on.
    const double turn = std::fmod(6 * hsv[0] + (c == 0 ? 0 : c == 1 ? 4 : 2), 6.0);
    const double far = std::clamp(2 - std::abs(turn - 3), 0.0, 1.0);
    rgb[c] = hsv[2] * (1 - hsv[1] * far);
  }
  return rgb;
}
}  // namespace

std::optional<std::size_t> CurveEditor::hit(double x, double y) const {
  std::optional<std::size_t> nearest;
  double least = reach;
  for (std::size_t n = 0; n < curve_.size(); ++n) {
    const double distance = std::hypot(curve_[n].value - x, curve_[n].opacity - y);
    if (distance > least) continue;
    least = distance;
    nearest = n;
  }
  return nearest;
}

std::vector<ColorPoint> CurveEditor::edited() const {
  return is_edited_ ? curve_ : std::vector<ColorPoint>();
}

void CurveEditor::drag(std::size_t point, double x, double y) {
  is_edited_ = true;
  curve_[point].opacity = std::clamp(y, 0.0, 1.0);
  if (point == 0 || point + 1 == curve_.size()) return;
  curve_[point].value = std::clamp(x, curve_[point - 1].value, curve_[point + 1].value);
}

void CurveEditor::tint(std::size_t point, double hue, double saturation) {
  is_edited_ = true;
  std::array<double, 3> hsv = hsv_of(curve_[point].color);
  hsv[0] += hue - std::floor(hsv[0] + hue);
  hsv[1] = std::clamp(hsv[1] + saturation, 0.0, 1.0);
  curve_[point].color = rgb_of(hsv);
}

}  // namespace tetwarp::view

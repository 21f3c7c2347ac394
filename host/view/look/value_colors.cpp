/// @file value_colors.cpp
/// The scale of colors and its ends.
#include "host/view/look/value_colors.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace tetwarp::view {
namespace {
constexpr std::array<Rgb, 5> scale{{{0.15, 0.20, 0.65},
                                    {0.10, 0.60, 0.75},
                                    {0.30, 0.75, 0.30},
                                    {0.95, 0.85, 0.20},
                                    {0.80, 0.10, 0.10}}};
}  // namespace

Rgb value_color(double share) {
  const double place = std::clamp(share, 0.0, 1.0) * (scale.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), scale.size() - 2);
  const double part = place - static_cast<double>(below);
  Rgb color{};
  for (std::size_t c = 0; c < 3; ++c) {
    color[c] = (1 - part) * scale[below][c] + part * scale[below + 1][c];
  }
  return color;
}

void ValueRange::include(SurfaceQuantity quantity, const std::vector<std::vector<float>>& values) {
  if (quantity != quantity_) *this = {};
  quantity_ = quantity;
  if (quantity == SurfaceQuantity::adhesion) high_ = 1;
  if (quantity == SurfaceQuantity::adhesion || quantity == SurfaceQuantity::none) return;
  for (const std::vector<float>& of_body : values) {
    for (const float value : of_body) {
      if (!std::isfinite(value)) continue;
      const bool starts_at_value = quantity == SurfaceQuantity::gap;
      if (!has_value_) low_ = high_ = starts_at_value ? value : 0;
      has_value_ = true;
      low_ = std::min<double>(low_, value);
      high_ = std::max<double>(high_, value);
    }
  }
}

double ValueRange::share(float value) const {
  return high_ > low_ ? (value - low_) / (high_ - low_) : value - low_;
}

}  // namespace tetwarp::view

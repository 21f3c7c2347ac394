/// @file sheet.cpp
/// Nodes on a grid, and two triangles a square.
#include "host/scene/shapes/sheet.hpp"

#include <cstdint>

#include "host/base/point3.hpp"
#include "host/scene/checks/scene_checks.hpp"

namespace tetwarp {
namespace {
constexpr std::int64_t most_squares = std::int64_t{1} << 30;
}

Surface make_sheet(const std::string& place, const Sheet& sheet) {
  if (sheet.cells[0] >= most_squares / sheet.cells[1]) {
    fail_at(key_of(place, "cells"), "2^30 or more squares; use fewer cells");
  }
  const auto [across, along] = sheet.cells;
  Surface surface;
  surface.points.reserve(static_cast<std::size_t>((across + 1) * (along + 1)));
  for (std::int64_t v = 0; v <= along; ++v) {
    const double y = sheet.size[1] * static_cast<double>(v) / static_cast<double>(along);
    for (std::int64_t u = 0; u <= across; ++u) {
      const double x = sheet.size[0] * static_cast<double>(u) / static_cast<double>(across);
      surface.points.push_back(
          plus(sheet.origin, plus(times(x, sheet.axes[0]), times(y, sheet.axes[1]))));
    }
  }
  surface.triangles.reserve(static_cast<std::size_t>(2 * across * along));
  for (std::int64_t v = 0; v < along; ++v) {
    for (std::int64_t u = 0; u < across; ++u) {
      const auto low = static_cast<std::int32_t>(v * (across + 1) + u);
      const auto high = static_cast<std::int32_t>(low + across + 1);
      surface.triangles.push_back({low, low + 1, high + 1});
      surface.triangles.push_back({low, high + 1, high});
    }
  }
  return surface;
}

}  // namespace tetwarp

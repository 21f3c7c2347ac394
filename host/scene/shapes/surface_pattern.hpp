/// @file surface_pattern.hpp
/// What the surfaces of all shapes share: counts of triangles, points.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>

#include <tetwarp/scene.hpp>

namespace tetwarp {

/// Whether triangles of a surface are of about one size, or flat faces and straight parts are
/// divided no more than their outline needs.
enum class Faces { divided, whole };

inline std::int32_t add_point(Surface& surface, const Point3& x) {
  surface.points.push_back(x);
  return static_cast<std::int32_t>(surface.points.size() - 1);
}

/// The pattern whose count of triangles, which grows with n, is nearest to the wanted one.
inline int nearest_pattern(int first,
                           std::int64_t wanted,
                           const std::function<double(int)>& count_of) {
  int n = first;
  while (count_of(n) < static_cast<double>(wanted)) ++n;
  const double over = count_of(n) - static_cast<double>(wanted);
  return n > first && static_cast<double>(wanted) - count_of(n - 1) <= over ? n - 1 : n;
}

inline int count_along(double length, double spacing) {
  constexpr double most = 1e8;
  return std::max(1, static_cast<int>(std::lround(std::min(length / spacing, most))));
}
/// Of a straight part.
inline int count_along(double length, double spacing, Faces faces) {
  return faces == Faces::whole ? 1 : count_along(length, spacing);
}

}  // namespace tetwarp

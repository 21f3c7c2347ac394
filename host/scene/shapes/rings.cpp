/// @file rings.cpp
/// Triangles between rings of points.
#include "host/scene/shapes/rings.hpp"

#include <cstdint>
#include <numbers>

#include "host/scene/shapes/surface_pattern.hpp"

namespace tetwarp {

Surface ring_surface(const Rings& rings) {
  Surface surface;
  const auto count = static_cast<std::int32_t>(rings.ring.size());
  const std::int32_t m = rings.around;
  for (const auto& ring : rings.ring) {
    for (int p = 0; p < m; ++p) add_point(surface, ring(2 * std::numbers::pi * p / m));
  }
  for (std::int32_t r = 0; r + 1 < count + (rings.is_loop ? 1 : 0); ++r) {
    const std::int32_t low = r * m, high = (r + 1) % count * m;
    for (std::int32_t p = 0; p < m; ++p) {
      const std::int32_t q = (p + 1) % m;
      surface.triangles.push_back({low + p, low + q, high + q});
      surface.triangles.push_back({low + p, high + q, high + p});
    }
  }
  if (rings.is_loop) return surface;
  const std::int32_t first = add_point(surface, rings.first_pole);
  const std::int32_t last = add_point(surface, rings.last_pole);
  for (std::int32_t p = 0; p < m; ++p) {
    const std::int32_t q = (p + 1) % m;
    surface.triangles.push_back({first, q, p});
    surface.triangles.push_back({last, (count - 1) * m + p, (count - 1) * m + q});
  }
  return surface;
}

double triangle_count(const Rings& rings) {
  return 2.0 * rings.around * static_cast<double>(rings.ring.size());
}

}  // namespace tetwarp

#include "host/simulate/contact/edge_side.hpp"

#include <algorithm>

#include "host/base/point3.hpp"

namespace tetwarp {

bool is_nearest(const CollisionSurfaces& surfaces,
                const TouchAreas& areas,
                std::int32_t edge,
                const Point3& toward,
                const std::vector<Point3>& vertices) {
  constexpr double sine_3 = 0.0523359562429438;
  const auto& [v, w] = at(surfaces.edges, edge);
  const Point3 along = unit(minus(at(vertices, w), at(vertices, v)));
  for (const std::int32_t t : areas.triangles_around(v)) {
    const auto& triangle = at(surfaces.triangles, t);
    if (std::find(triangle.begin(), triangle.end(), w) == triangle.end()) continue;
    for (const std::int32_t opposite : triangle) {
      if (opposite == v || opposite == w) continue;
      const Point3 into = minus(at(vertices, opposite), at(vertices, v));
      const Point3 across = unit(minus(into, times(dot(into, along), along)));
      if (dot(across, toward) > sine_3) return false;
    }
  }
  return true;
}

}  // namespace tetwarp

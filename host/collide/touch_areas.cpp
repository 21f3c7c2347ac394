/// @file touch_areas.cpp
/// Lists of triangles around vertices, and mean areas.
#include "host/collide/touch_areas.hpp"

#include <algorithm>
#include <limits>

#include "host/base/point3.hpp"
#include "host/base/vector_view.hpp"

namespace tetwarp {
TouchAreas::TouchAreas(const CollisionSurfaces& surfaces)
    : start(surfaces.vertex_body.size() + 1), surfaces_(surfaces) {
  for (const auto& corners : surfaces.triangles) {
    for (const std::int32_t vertex : corners) ++start[static_cast<std::size_t>(vertex) + 1];
  }
  for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
  triangle.resize(3 * surfaces.triangles.size());
  std::vector<std::int32_t> next = start;
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t) {
    for (const std::int32_t vertex : surfaces.triangles[t]) {
      triangle[static_cast<std::size_t>(next[static_cast<std::size_t>(vertex)]++)] =
          static_cast<std::int32_t>(t);
    }
  }
  for (const CollisionBody& body : surfaces.bodies) {
    double sum = 0;
    bool has_flat = false;
    for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
      sum += at(surfaces.vertex_area, v);
      has_flat =
          has_flat || (!surfaces.vertex_is_flat.empty() && at(surfaces.vertex_is_flat, v) != 0);
    }
    mean_area.push_back(has_flat ? std::numeric_limits<double>::infinity()
                                 : sum / std::max(1, body.vertex_end - body.first_vertex));
  }
}

TouchAreaView TouchAreas::view() const {
  const auto& corners = surfaces_.triangles;
  return {view_of(start),
          view_of(triangle),
          {corners.empty() ? nullptr : corners[0].data(),
           3 * static_cast<std::int64_t>(corners.size())},
          view_of(surfaces_.vertex_area),
          view_of(mean_area)};
}

}  // namespace tetwarp

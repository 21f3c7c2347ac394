#include "host/simulate/contact/touch_area.hpp"

#include <algorithm>

#include "host/base/point3.hpp"

namespace tetwarp {

TouchAreas::TouchAreas(const CollisionSurfaces& surfaces)
    : surfaces_(surfaces), start_(surfaces.vertex_body.size() + 1) {
  for (const auto& triangle : surfaces.triangles) {
    for (const std::int32_t vertex : triangle) ++start_[static_cast<std::size_t>(vertex) + 1];
  }
  for (std::size_t v = 1; v < start_.size(); ++v) start_[v] += start_[v - 1];
  triangle_.resize(3 * surfaces.triangles.size());
  std::vector<std::int32_t> next = start_;
  for (std::size_t t = 0; t < surfaces.triangles.size(); ++t) {
    for (const std::int32_t vertex : surfaces.triangles[t]) {
      triangle_[static_cast<std::size_t>(next[static_cast<std::size_t>(vertex)]++)] =
          static_cast<std::int32_t>(t);
    }
  }
  for (const CollisionBody& body : surfaces.bodies) {
    double sum = 0;
    for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
      sum += at(surfaces.vertex_area, v);
    }
    mean_area_.push_back(sum / std::max(1, body.vertex_end - body.first_vertex));
  }
}

TouchAreas::Seen TouchAreas::around(std::int32_t vertex,
                                    const Point3& direction,
                                    const std::vector<Point3>& vertices) const {
  Seen seen;
  for (const std::int32_t t : triangles_around(vertex)) {
    const auto& [a, b, c] = at(surfaces_.triangles, t);
    const Point3& x = at(vertices, a);
    const Point3 normal = cross(minus(at(vertices, b), x), minus(at(vertices, c), x));
    const double along = dot(normal, direction) / 2;
    seen.all += norm(normal) / 2;
    (along > 0 ? seen.along : seen.against) += std::abs(along);
  }
  return seen;
}

double TouchAreas::seen(std::int32_t vertex,
                        const Point3& direction,
                        const std::vector<Point3>& vertices) const {
  const double area = at(surfaces_.vertex_area, vertex);
  if (!(area > 0)) return 0;
  const Seen seen = around(vertex, direction, vertices);
  return seen.all > 0 ? area * std::min(1.0, std::max(seen.along, seen.against) / seen.all) : 0;
}

double TouchAreas::facing(std::int32_t triangle,
                          const Point3& direction,
                          const std::vector<Point3>& vertices) const {
  const auto& [a, b, c] = at(surfaces_.triangles, triangle);
  const Point3& x = at(vertices, a);
  return dot(cross(minus(at(vertices, b), x), minus(at(vertices, c), x)), direction) / 2;
}

double TouchAreas::side(std::int32_t vertex,
                        const Point3& direction,
                        const std::vector<Point3>& vertices) const {
  const Seen seen = around(vertex, direction, vertices);
  return seen.along >= seen.against ? 1 : -1;
}

double TouchAreas::share(std::int32_t body, std::int32_t other) const {
  const double own = at(mean_area_, body), others = at(mean_area_, other);
  return own + others > 0 ? others / (own + others) : 0.5;
}

}  // namespace tetwarp

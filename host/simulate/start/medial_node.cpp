/// @file medial_node.cpp
/// Searches the node that is farthest from the surfaces of its body and of others.
#include "host/simulate/start/medial_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "host/base/point3.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "host/simulate/model/nearest.hpp"

namespace tetwarp {
namespace {

/// Distance of points from the surface of a body or obstacle.
class BodyDistance {
 public:
  BodyDistance(const CollisionSurfaces& surfaces, const SurfacePlaces& places, std::int32_t body)
      : surfaces_(surfaces), places_(places), body_(at(surfaces.bodies, body)) {
    if (body_.first_triangle == body_.triangle_end) return;
    triangles_.points.assign(places.vertices.begin() + body_.first_vertex,
                             places.vertices.begin() + body_.vertex_end);
    for (std::int32_t t = body_.first_triangle; t < body_.triangle_end; ++t) {
      auto& own = triangles_.triangles.emplace_back(at(surfaces.triangles, t));
      for (std::int32_t& corner : own) corner -= body_.first_vertex;
    }
    search_ = std::make_unique<NearestItems<3>>(triangles_.points, triangles_.triangles);
  }

  /// Of triangles without a sign; negative inside round bodies and below planes.
  double at_point(const Point3& x) const {
    double least = search_ ? search_->find(x).distance : std::numeric_limits<double>::infinity();
    for (std::int32_t p = body_.first_plane; p < body_.plane_end; ++p) {
      const PlanePlace& plane = at(places_.planes, p);
      least = std::min(least, dot(plane.normal, minus(x, plane.point)));
    }
    for (std::int32_t v = body_.first_vertex; v < body_.vertex_end; ++v) {
      const double radius = at(surfaces_.vertex_radius, v);
      if (radius > 0) least = std::min(least, norm(minus(x, place(v))) - radius);
    }
    for (std::int32_t e = body_.first_edge; e < body_.edge_end; ++e) {
      const double radius = at(surfaces_.edge_radius, e);
      if (radius == 0) continue;
      const auto& [a, b] = at(surfaces_.edges, e);
      least = std::min(least, nearest_on(std::array{place(a), place(b)}, x).distance - radius);
    }
    return least;
  }
  bool has_within(const Point3& x) const { return search_ && winding_number(triangles_, x) > 0.5; }

 private:
  const Point3& place(std::int32_t vertex) const { return at(places_.vertices, vertex); }

  const CollisionSurfaces& surfaces_;
  const SurfacePlaces& places_;
  const CollisionBody& body_;
  Surface triangles_;
  std::unique_ptr<NearestItems<3>> search_;
};

/// The distance of each node of cloth from its border.
std::vector<double> depths_of_cloth(const std::vector<Point3>& nodes) {
  Point3 mean{0, 0, 0};
  for (const Point3& x : nodes) mean = plus(mean, times(1 / static_cast<double>(nodes.size()), x));
  std::vector<double> depths;
  double reach = 0;
  for (const Point3& x : nodes) {
    depths.push_back(-norm(minus(x, mean)));
    reach = std::max(reach, -depths.back());
  }
  for (double& depth : depths) depth += reach;
  return depths;
}

}  // namespace

Point3 medial_node(const StartParts& parts,
                   const SurfacePlaces& places,
                   const std::vector<Point3>& nodes,
                   std::int32_t body,
                   const std::vector<std::int32_t>& others) {
  const CollisionSurfaces& surfaces = parts.surfaces.surfaces;
  const bool is_cloth = parts.geometry.bodies[static_cast<std::size_t>(body)].tets.empty();
  const BodyDistance own(surfaces, places, body);
  std::vector<BodyDistance> from;
  from.reserve(others.size());
  for (const std::int32_t other : others) from.emplace_back(surfaces, places, other);

  std::vector<double> depths = depths_of_cloth(nodes);
  if (!is_cloth) {
    for (std::size_t n = 0; n < nodes.size(); ++n) depths[n] = own.at_point(nodes[n]);
  }
  std::vector<std::pair<double, std::size_t>> order;  // by falling distance, then number
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    double least = depths[n];
    for (const BodyDistance& other : from) least = std::min(least, other.at_point(nodes[n]));
    order.emplace_back(-least, n);
  }
  std::sort(order.begin(), order.end());
  const auto is_inside = [&](std::size_t n) { return is_cloth || own.has_within(nodes[n]); };
  const auto found = std::find_if(order.begin(), order.end(), [&](const auto& entry) {
    const Point3& x = nodes[entry.second];
    return entry.first < 0 && is_inside(entry.second) &&
           std::none_of(from.begin(), from.end(),
                        [&](const BodyDistance& other) { return other.has_within(x); });
  });
  if (found != order.end()) return nodes[found->second];
  std::size_t deepest = 0;
  double depth = -1;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (depths[n] <= depth || !is_inside(n)) continue;
    depth = depths[n];
    deepest = n;
  }
  return nodes[deepest];
}

}  // namespace tetwarp

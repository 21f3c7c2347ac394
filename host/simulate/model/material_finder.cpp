/// @file material_finder.cpp
/// Searches bodies by NearestItems, and obstacles by their shapes.
#include "host/simulate/model/material_finder.hpp"

#include <limits>
#include <stdexcept>
#include <variant>

#include "host/base/index_of.hpp"
#include "host/scene/shapes/surface_lattice.hpp"
#include "host/simulate/model/nearest.hpp"
#include "host/simulate/model/rotations.hpp"

namespace tetwarp {
namespace {
Point3 nearest_in_ball(const Point3& center, double radius, const Point3& x) {
  const double distance = norm(minus(x, center));
  return distance <= radius ? x : plus(center, times(radius / distance, minus(x, center)));
}

}  // namespace

struct MaterialFinder::Search {
  std::vector<Point3> points;
  std::unique_ptr<NearestItems<4>> tets;
  std::unique_ptr<NearestItems<3>> triangles;
  const Surface* surface = nullptr;                  ///< of a solid, in its own frame
  std::vector<std::array<std::int32_t, 3>> corners;  ///< of `triangles`

  /// The point of a solid nearest to a point, in its own frame; inside, the point itself.
  Point3 nearest_of_solid(const Point3& x) const {
    if (surface->triangles.empty() || winding_number(*surface, x) > 0.5) return x;
    const NearestPoint<3> found = triangles->find(x);
    Point3 nearest{0, 0, 0};
    for (std::size_t c = 0; c < 3; ++c) {
      nearest = plus(nearest, times(found.weight[c], at(points, at(corners, found.item)[c])));
    }
    return nearest;
  }
};

MaterialFinder::MaterialFinder(const Scene& scene,
                               const SceneGeometry& geometry,
                               const Model& model)
    : scene_(scene),
      geometry_(geometry),
      model_(model),
      searches_(scene.bodies.size() + scene.obstacles.size()) {}

MaterialFinder::~MaterialFinder() = default;

MaterialFinder::Search& MaterialFinder::search_of(std::int32_t body) {
  auto& search = searches_[index_of(body)];
  if (search) return *search;
  search = std::make_unique<Search>();
  const std::size_t bodies = scene_.bodies.size();
  if (index_of(body) >= bodies) {
    search->surface = &std::get<Surface>(scene_.obstacles[index_of(body) - bodies].geometry);
  } else {
    const BodyGeometry& of = geometry_.bodies[index_of(body)];
    if (of.nodes.empty()) {
      search->surface = &of.surface;
    } else {
      const auto first = model_.start.position.begin() + at(model_.body_node, body);
      search->points.assign(first, first + static_cast<std::ptrdiff_t>(of.nodes.size()));
      search->corners = of.cloth_triangles.empty() ? of.surface.triangles : of.cloth_triangles;
      if (!of.tets.empty()) {
        search->tets = std::make_unique<NearestItems<4>>(search->points, of.tets);
        return *search;
      }
    }
  }
  if (search->surface) {
    search->points = search->surface->points;
    search->corners = search->surface->triangles;
  }
  search->triangles = std::make_unique<NearestItems<3>>(search->points, search->corners);
  return *search;
}

NearestMaterial MaterialFinder::nearest_of_body(std::int32_t body, const Point3& x_world) {
  NearestMaterial result;
  result.point.body = body;
  const Search& search = search_of(body);
  const auto bind = [&](const auto& found, const auto& nodes) {
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      result.point.node[a] = at(model_.body_node, body) + nodes[a];
      result.point.weight[a] = found.weight[a];
    }
    result.distance = found.distance;
  };
  if (search.tets) {
    const auto found = search.tets->find(x_world);
    bind(found, at(geometry_.bodies[index_of(body)].tets, found.item));
  } else if (search.surface) {
    const std::int32_t rigid = at(model_.body_rigid, body);
    const Quaternion& axes = at(model_.rigid.axes, rigid);
    const Point3& center = at(model_.rigid.center, rigid);
    const Point3 arm = minus(x_world, at(model_.start.position, model_.node_count + rigid));
    const Point3 principal = rotate(conjugate(at(model_.start.rotation, rigid)), arm);
    const Point3 local = plus(center, rotate(axes, principal));
    const Point3 nearest = search.nearest_of_solid(local);
    result.point.rigid = rigid;
    result.point.local = rotate(conjugate(axes), minus(nearest, center));
    result.distance = norm(minus(nearest, local));
  } else if (!search.corners.empty()) {
    const auto found = search.triangles->find(x_world);
    bind(found, at(search.corners, found.item));
  }
  return result;
}

NearestMaterial MaterialFinder::nearest(const std::string& name, const Point3& x_world) {
  for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
    if (scene_.bodies[b].name == name) {
      return nearest_of_body(static_cast<std::int32_t>(b), x_world);
    }
  }
  NearestMaterial result;
  result.point.local = x_world;
  if (name == "world") return result;
  for (std::size_t o = 0; o < scene_.obstacles.size(); ++o) {
    const Obstacle& obstacle = scene_.obstacles[o];
    if (obstacle.name != name) continue;
    const auto body = static_cast<std::int32_t>(scene_.bodies.size() + o);
    for (std::int32_t r = 0; r < model_.rigid_count; ++r) {
      if (at(model_.rigid.body, r) == body) result.point.rigid = r;
    }
    const std::int32_t frame = model_.node_count + result.point.rigid;
    const Quaternion& turn = at(model_.start.rotation, result.point.rigid);
    const Point3 x = rotate(conjugate(turn), minus(x_world, at(model_.start.position, frame)));
    Point3 nearest = x;
    if (const auto* plane = std::get_if<PlaneObstacle>(&obstacle.geometry)) {
      const Point3 normal = times(1 / norm(plane->normal), plane->normal);
      const double height = dot(normal, minus(x, plane->point));
      if (height > 0) nearest = minus(x, times(height, normal));
    } else if (const auto* sphere = std::get_if<SphereObstacle>(&obstacle.geometry)) {
      nearest = nearest_in_ball(sphere->center, sphere->radius, x);
    } else if (const auto* capsule = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
      const auto [w0, w1] = nearest_on(std::array{capsule->from, capsule->to}, x).weight;
      const Point3 foot = plus(times(w0, capsule->from), times(w1, capsule->to));
      nearest = nearest_in_ball(foot, capsule->radius, x);
    } else {
      nearest = search_of(body).nearest_of_solid(x);
    }
    result.point.body = body;
    result.point.local = nearest;
    result.distance = norm(minus(nearest, x));
    return result;
  }
  throw std::invalid_argument("couplings: there is no body or obstacle \"" + name + "\"");
}

ModelPoint MaterialFinder::fixed_at(const std::string& name, const Point3& x_world) {
  ModelPoint point = nearest(name, x_world).point;
  if (point.rigid < 0) return point;
  const Point3 arm = minus(x_world, at(model_.start.position, model_.node_count + point.rigid));
  point.local = rotate(conjugate(at(model_.start.rotation, point.rigid)), arm);
  return point;
}

}  // namespace tetwarp

/// @file scene_surfaces.cpp
/// Collects vertices, triangles and planes of all bodies and obstacles.
#include "host/simulate/surfaces/scene_surfaces.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "host/base/index_of.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/surfaces/contact_thickness.hpp"
#include "host/simulate/surfaces/flat_edges.hpp"
#include "host/simulate/surfaces/pair_materials.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {
namespace {

using Triangle = std::array<std::int32_t, 3>;

template <class T>
std::int32_t count_of(const std::vector<T>& list) {
  return static_cast<std::int32_t>(list.size());
}

/// Adds the parts of bodies and obstacles, one after the other.
class SurfaceParts {
 public:
  SurfaceParts(const Scene& scene,
               const SceneGeometry& geometry,
               const Model& model,
               SceneSurfaces& result)
      : scene_(scene), geometry_(geometry), model_(model), result_(result) {
    frame_.assign(scene.bodies.size() + scene.obstacles.size(), -1);
    for (std::int32_t r = 0; r < model.rigid_count; ++r) {
      frame_[index_of(at(model.rigid.body, r))] = r;
    }
  }

  void add_body(std::int32_t body) {
    const Body& of = scene_.bodies[index_of(body)];
    begin(body);
    CollisionBody& parts = result_.surfaces.bodies.back();
    parts.has_unknowns = has_unknowns(body);
    const bool is_self = of.self.value_or(of.kind == BodyKind::cloth);
    parts.touches_itself =
        is_self && of.kind != BodyKind::rigid && parts.has_unknowns && !is_forbidden(body, body);
    if (of.collide) {
      const auto round = round_shape_of(of);
      if (round && !adheres_to_any(body)) {
        add_round(*round);
      } else {
        add_surface(bound_surface(model_, geometry_, body),
                    geometry_.bodies[index_of(body)].surface.triangles);
      }
    }
    end();
  }

  void add_obstacle(std::int32_t body) {
    const Obstacle& of = scene_.obstacles[index_of(body) - scene_.bodies.size()];
    begin(body);
    const auto round = round_shape_of(of);
    if (const auto* plane = std::get_if<PlaneObstacle>(&of.geometry)) {
      result_.surfaces.plane_body.push_back(body);
      result_.plane_rigid.push_back(at(frame_, body));
      result_.plane_local.push_back({plane->point, unit(plane->normal)});
    } else if (round && !adheres_to_any(body)) {
      add_round(*round);
    } else {
      const Surface& given = round ? surface_of(*round) : std::get<Surface>(of.geometry);
      std::vector<ModelPoint> points;
      for (const Point3& x : given.points) points.push_back(fixed_point(x));
      add_surface(points, given.triangles);
    }
    end();
  }

  /// After the thickness is known. Vertices of bodies that adhere stay: their areas touch.
  void mark_flat_faces() {
    CollisionSurfaces& surfaces = result_.surfaces;
    surfaces.edge_is_flat.assign(surfaces.edges.size(), 0);
    surfaces.vertex_is_flat.assign(surfaces.vertex_body.size(), 0);
    std::vector<Point3> position;
    for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
      if (!keeps_shape(b)) continue;
      const CollisionBody& body = surfaces.bodies[b];
      position.clear();
      for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
        position.push_back(body.is_rigid ? at(result_.vertex_point, v).local : start_of(v));
      }
      mark_flat_edges(surfaces, body, position, flat_share * surfaces.thickness);
      if (!adheres_to_any(static_cast<std::int32_t>(b))) continue;
      for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
        surfaces.vertex_is_flat[index_of(v)] = 0;
      }
    }
  }

 private:
  // Largest distance of a flat face's vertices from its plane; the end check has a slack of 0.05.
  static constexpr double flat_share = 1e-3;  // thicknesses

  void begin(std::int32_t body) {
    body_ = body;
    CollisionSurfaces& surfaces = result_.surfaces;
    CollisionBody& parts = surfaces.bodies.emplace_back();
    parts.first_vertex = count_of(surfaces.vertex_body);
    parts.first_edge = count_of(surfaces.edges);
    parts.first_triangle = count_of(surfaces.triangles);
    parts.first_plane = count_of(surfaces.plane_body);
  }

  void end() {
    CollisionSurfaces& surfaces = result_.surfaces;
    CollisionBody& parts = surfaces.bodies.back();
    parts.vertex_end = count_of(surfaces.vertex_body);
    parts.edge_end = count_of(surfaces.edges);
    parts.triangle_end = count_of(surfaces.triangles);
    parts.plane_end = count_of(surfaces.plane_body);
    const bool has_nodes =
        index_of(body_) < scene_.bodies.size() && !geometry_.bodies[index_of(body_)].nodes.empty();
    result_.body_rigid.push_back(has_nodes ? -1 : at(frame_, body_));
    parts.is_rigid = result_.body_rigid.back() >= 0;
    result_.body_size.push_back(size_of(parts));
  }

  /// Whether all motions of a body or obstacle are rigid.
  bool keeps_shape(std::size_t body) const {
    if (result_.surfaces.bodies[body].is_rigid) return true;
    if (body >= scene_.bodies.size()) return false;
    const Body& of = scene_.bodies[body];
    return of.kind == BodyKind::scripted && !std::holds_alternative<Wave>(of.motion);
  }

  /// Whether a body or obstacle has unknowns.
  bool has_unknowns(std::int32_t body) const {
    if (index_of(body) >= scene_.bodies.size()) return false;
    const auto is_free = [&](std::int32_t block) { return at(model_.prescribed, block) == 0; };
    for (std::int32_t n = at(model_.body_node, body); n < at(model_.body_node, body + 1); ++n) {
      if (is_free(n)) return true;
    }
    const std::int32_t rigid = at(model_.body_rigid, body);
    return rigid >= 0 && is_free(model_.node_count + 2 * rigid);
  }

  bool is_forbidden(std::int32_t a, std::int32_t b) const {
    const auto& forbidden = result_.surfaces.forbidden;
    return std::binary_search(forbidden.begin(), forbidden.end(),
                              std::array<std::int32_t, 2>{std::min(a, b), std::max(a, b)});
  }

  /// Whether another body that the body may meet can hold it by adhesion.
  bool adheres_to_any(std::int32_t body) const {
    const auto& materials = result_.materials;
    if (std::none_of(materials.begin(), materials.end(), adheres)) return false;
    for (std::int32_t other = 0; other < count_of(frame_); ++other) {
      const bool is_body = index_of(other) < scene_.bodies.size();
      if (other == body || (is_body && !scene_.bodies[index_of(other)].collide)) continue;
      if (!has_unknowns(body) && !has_unknowns(other)) continue;
      if (adheres(at(materials, result_.material_of(body, other))) && !is_forbidden(body, other)) {
        return true;
      }
    }
    return false;
  }

  /// A point of the frame of the current body, given in coordinates of its geometry. @pre the body
  /// has a frame
  ModelPoint fixed_point(const Point3& x) const {
    ModelPoint point;
    point.body = body_;
    point.rigid = at(frame_, body_);
    point.local = rotate(conjugate(at(model_.rigid.axes, point.rigid)),
                         minus(x, at(model_.rigid.center, point.rigid)));
    return point;
  }

  void add_vertex(const ModelPoint& point, std::int32_t surface_point, double radius) {
    result_.vertex_point.push_back(point);
    result_.surface_point.push_back(surface_point);
    result_.surfaces.vertex_body.push_back(body_);
    result_.surfaces.vertex_radius.push_back(radius);
    result_.surfaces.vertex_area.push_back(0);
  }

  void add_round(const RoundShape& shape) {
    add_vertex(fixed_point(shape.from), -1, shape.radius);
    if (shape.is_sphere()) return;
    add_vertex(fixed_point(shape.to), -1, shape.radius);
    const std::int32_t last = count_of(result_.vertex_point) - 1;
    result_.surfaces.edges.push_back({last - 1, last});
    result_.surfaces.edge_radius.push_back(shape.radius);
  }

  void check_counts(const std::vector<Triangle>& triangles) const {
    constexpr auto most = static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
    if (result_.surfaces.edges.size() + 3 * triangles.size() < most) return;
    throw std::invalid_argument(place_of_body(scene_, body_) +
                                ": the surfaces of the scene have 2^31 or more edges; use coarser "
                                "surfaces or set collide to false");
  }

  /// Adds triangles, and those of the points that they use.
  void add_surface(const std::vector<ModelPoint>& points, const std::vector<Triangle>& triangles) {
    check_counts(triangles);
    std::vector<std::int32_t> number(points.size(), -1);
    for (const Triangle& triangle : triangles) {
      for (const std::int32_t corner : triangle) number[index_of(corner)] = 0;
    }
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (number[p] < 0) continue;
      number[p] = count_of(result_.vertex_point);
      add_vertex(points[p], static_cast<std::int32_t>(p), 0);
    }
    CollisionSurfaces& surfaces = result_.surfaces;
    std::vector<std::array<std::int32_t, 2>> edges;
    for (const Triangle& triangle : triangles) {
      Triangle own{};
      for (std::size_t c = 0; c < 3; ++c) own[c] = at(number, triangle[c]);
      surfaces.triangles.push_back(own);
      for (std::size_t c = 0; c < 3; ++c) {
        const auto [low, high] = std::minmax(own[c], own[(c + 1) % 3]);
        edges.push_back({low, high});
      }
      add_area(own);
    }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    surfaces.edges.insert(surfaces.edges.end(), edges.begin(), edges.end());
    surfaces.edge_radius.resize(surfaces.edges.size(), 0);
  }

  Point3 start_of(std::int32_t vertex) const {
    return position_of(at(result_.vertex_point, vertex), model_.start, model_.node_count);
  }

  void add_area(const Triangle& triangle) {
    const Point3 a = start_of(triangle[0]);
    const Point3 normal = cross(minus(start_of(triangle[1]), a), minus(start_of(triangle[2]), a));
    for (const std::int32_t corner : triangle) {
      result_.surfaces.vertex_area[index_of(corner)] += norm(normal) / 6;
    }
  }

  double size_of(const CollisionBody& parts) const {
    if (parts.plane_end > parts.first_plane) return std::numeric_limits<double>::infinity();
    if (parts.vertex_end == parts.first_vertex) return 0;
    Bounds bounds;
    for (std::int32_t v = parts.first_vertex; v < parts.vertex_end; ++v) {
      const double radius = at(result_.surfaces.vertex_radius, v);
      const Point3 x = start_of(v), reach{radius, radius, radius};
      bounds.include(minus(x, reach));
      bounds.include(plus(x, reach));
    }
    return norm(minus(bounds.high, bounds.low));
  }

  const Scene& scene_;
  const SceneGeometry& geometry_;
  const Model& model_;
  SceneSurfaces& result_;
  std::vector<std::int32_t> frame_;  ///< [bodies, then obstacles] frame in the model, or -1
  std::int32_t body_ = 0;            ///< the one whose parts are added
};

void add_forbidden(const Scene& scene, CollisionSurfaces& surfaces) {
  std::map<std::string, std::int32_t> index;
  for (const Body& body : scene.bodies)
    index.emplace(body.name, static_cast<std::int32_t>(index.size()));
  for (const Obstacle& obstacle : scene.obstacles)
    index.emplace(obstacle.name, static_cast<std::int32_t>(index.size()));
  const auto forbid = [&](const std::string& a, const std::string& b) {
    const auto [low, high] = std::minmax(index.at(a), index.at(b));
    surfaces.forbidden.push_back({low, high});
  };
  for (const ContactPairMaterial& pair : scene.contact.pairs) {
    if (!pair.collide) forbid(pair.a, pair.b);
  }
  for (const Coupling& coupling : scene.couplings) {
    if (!coupling.collide && coupling.b != "world") forbid(coupling.a, coupling.b);
  }
  auto& pairs = surfaces.forbidden;
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

}  // namespace

SceneSurfaces make_scene_surfaces(const Scene& scene,
                                  const SceneGeometry& geometry,
                                  const Model& model) {
  SceneSurfaces result;
  add_pair_materials(scene, result);
  add_forbidden(scene, result.surfaces);
  SurfaceParts parts(scene, geometry, model, result);
  const auto bodies = static_cast<std::int32_t>(scene.bodies.size());
  const auto obstacles = static_cast<std::int32_t>(scene.obstacles.size());
  for (std::int32_t b = 0; b < bodies; ++b) parts.add_body(b);
  for (std::int32_t o = 0; o < obstacles; ++o) parts.add_obstacle(bodies + o);
  result.surfaces.thickness = contact_thickness(scene, geometry, model, result);
  parts.mark_flat_faces();
  return result;
}

}  // namespace tetwarp

/// @file contact_thickness.cpp
/// The thickness that a scene gives or its edges suggest, and whether positions resolve it.
#include "host/simulate/surfaces/contact_thickness.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <variant>

#include "host/base/point3.hpp"
#include "host/scene/checks/scene_checks.hpp"
#include "host/scene/shapes/shape_surface.hpp"
#include "host/simulate/model/body_points.hpp"
#include "host/simulate/surfaces/round_shape.hpp"

namespace tetwarp {
namespace {

constexpr double default_fraction = 1e-3;
constexpr double least_of_feature = 1e-10;     // of the largest edge or radius
constexpr double least_of_coordinate = 1e-12;  // 4500 times the rounding of the coordinate

/// Appends the lengths of the edges of a shape's surface whose faces are divided.
void add_divided_edges(const Shape& shape, std::vector<double>& lengths) {
  const Surface surface = make_shape_surface(shape, default_triangles);
  for (const auto& triangle : surface.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t a = triangle[c], b = triangle[(c + 1) % 3];  // the other side has b, a
      if (a < b) lengths.push_back(norm(minus(at(surface.points, a), at(surface.points, b))));
    }
  }
}

double default_thickness(const Scene& scene,
                         const SceneGeometry& geometry,
                         const CollisionSurfaces& surfaces,
                         const std::vector<double>& lengths) {
  std::vector<double> edges;
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    const bool has_whole_faces = b < geometry.bodies.size() && geometry.bodies[b].has_whole_faces;
    if (has_whole_faces && body.triangle_end > body.first_triangle) {
      add_divided_edges(std::get<Shape>(scene.bodies[b].geometry), edges);
      continue;
    }
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      if (at(surfaces.edge_radius, e) == 0) edges.push_back(at(lengths, e));
    }
  }
  if (!edges.empty()) {
    const auto middle = edges.begin() + static_cast<std::ptrdiff_t>(edges.size() / 2);
    std::nth_element(edges.begin(), middle, edges.end());
    return default_fraction * *middle;
  }
  double smallest = 0;
  for (const double radius : surfaces.vertex_radius) {
    if (radius > 0 && (smallest == 0 || radius < smallest)) smallest = radius;
  }
  return smallest > 0 ? default_fraction * smallest : 1e-3;
}

void check_resolution(const Scene& scene,
                      const CollisionSurfaces& surfaces,
                      const std::vector<Point3>& places,
                      const std::vector<double>& lengths,
                      double thickness) {
  for (std::size_t b = 0; b < surfaces.bodies.size(); ++b) {
    const CollisionBody& body = surfaces.bodies[b];
    double feature = 0, coordinate = 0;
    for (std::int32_t e = body.first_edge; e < body.edge_end; ++e) {
      feature = std::max(feature, at(lengths, e));
    }
    for (std::int32_t v = body.first_vertex; v < body.vertex_end; ++v) {
      feature = std::max(feature, at(surfaces.vertex_radius, v));
      for (const double x : at(places, v)) coordinate = std::max(coordinate, std::fabs(x));
    }
    const double least = std::max(least_of_feature * feature, least_of_coordinate * coordinate);
    if (thickness > 0 && thickness >= least) continue;
    const bool is_far = least > least_of_feature * feature;
    throw std::invalid_argument(
        place_of_body(scene, static_cast<std::int32_t>(b)) + ": the contact distance " +
        number_text(thickness) + " m cannot be resolved " +
        (is_far ? "at coordinates of " + number_text(coordinate) +
                      " m; move the scene nearer to "
                      "the origin, or "
                : "on edges or radii of " + number_text(feature) + " m; divide them, or ") +
        "set thickness to " + number_text(least) + " or more");
  }
}

}  // namespace

double contact_thickness(const Scene& scene,
                         const SceneGeometry& geometry,
                         const Model& model,
                         const SceneSurfaces& surfaces) {
  std::vector<Point3> places;
  places.reserve(surfaces.vertex_point.size());
  for (const ModelPoint& point : surfaces.vertex_point) {
    places.push_back(position_of(point, model.start, model.node_count));
  }
  std::vector<double> lengths;
  lengths.reserve(surfaces.surfaces.edges.size());
  for (const auto& [a, b] : surfaces.surfaces.edges) {
    lengths.push_back(norm(minus(at(places, a), at(places, b))));
  }
  const double thickness = scene.thickness
                               ? *scene.thickness
                               : default_thickness(scene, geometry, surfaces.surfaces, lengths);
  check_resolution(scene, surfaces.surfaces, places, lengths, thickness);
  return thickness;
}

}  // namespace tetwarp

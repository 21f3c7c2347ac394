/// @file shares.cpp
/// Lumped volumes and areas of points, and the bindings of surfaces.
#include "host/reference/simulate/shares.hpp"

#include "host/reference/simulate/make_system.hpp"
#include "host/reference/simulate/nearest_material.hpp"

namespace tetwarp::reference {
namespace {

void add_area_thirds(const std::vector<Point3>& points,
                     const std::vector<std::array<std::int32_t, 3>>& triangles,
                     std::vector<double>& shares) {
  for (const auto& triangle : triangles) {
    std::array<Vector3d, 3> x;
    for (std::size_t c = 0; c < 3; ++c) {
      x[c] = vector_of(points[static_cast<std::size_t>(triangle[c])]);
    }
    const double third = (x[1] - x[0]).cross(x[2] - x[0]).norm() / 6;
    for (const int point : triangle) shares[static_cast<std::size_t>(point)] += third;
  }
}

}  // namespace

MaterialPoint selected_point(const System& system, int body, int index) {
  const auto b = static_cast<std::size_t>(body);
  const BodyPlace& place = system.places[b];
  MaterialPoint point;
  point.body = body;
  if (place.node_count > 0) {
    point.nodes = {place.first_node + index};
    point.weights = {1};
    return point;
  }
  const Point3& local = system.geometry.bodies[b].surface.points[static_cast<std::size_t>(index)];
  point.rigid = place.rigid;
  point.local = vector_of(local) - system.rigids[static_cast<std::size_t>(place.rigid)].center;
  return point;
}

void bind_surfaces(System& system) {
  State rest;
  for (const BodyGeometry& of : system.geometry.bodies) {
    for (const Point3& node : of.nodes) rest.node.push_back(vector_of(node));
  }
  for (std::size_t b = 0; b < system.scene.bodies.size(); ++b) {
    const BodyGeometry& geometry = system.geometry.bodies[b];
    std::vector<MaterialPoint> points;
    for (std::size_t i = 0; i < geometry.surface.points.size(); ++i) {
      if (!geometry.surface_node.empty()) {
        points.push_back(selected_point(system, static_cast<int>(b), geometry.surface_node[i]));
      } else if (geometry.tets.empty()) {
        points.push_back(selected_point(system, static_cast<int>(b), static_cast<int>(i)));
      } else {
        const Vector3d x = vector_of(geometry.surface.points[i]);
        points.push_back(nearest_material(system.scene.bodies[b].name, x, rest, system).point);
      }
    }
    system.surfaces.push_back(points);
  }
}

std::vector<double> shares_of(const System& system, int body, const std::vector<int>& selected) {
  const BodyGeometry& geometry = system.geometry.bodies[static_cast<std::size_t>(body)];
  const bool has_nodes = !geometry.nodes.empty();
  std::vector<double> all(has_nodes ? geometry.nodes.size() : geometry.surface.points.size(), 0.0);
  for (const auto& tet : geometry.tets) {
    Matrix34 rest;
    for (int a = 0; a < 4; ++a) {
      const auto node = static_cast<std::size_t>(tet[static_cast<std::size_t>(a)]);
      rest.col(a) = vector_of(geometry.nodes[node]);
    }
    const double volume = element_of(tet, rest).volume;
    for (const int node : tet) all[static_cast<std::size_t>(node)] += volume / 4;
  }
  if (has_nodes && geometry.tets.empty()) {
    add_area_thirds(geometry.nodes, geometry.cloth_triangles, all);
  } else if (!has_nodes) {
    add_area_thirds(geometry.surface.points, geometry.surface.triangles, all);
  }
  std::vector<double> shares;
  shares.reserve(selected.size());
  for (const int index : selected) shares.push_back(all[static_cast<std::size_t>(index)]);
  return shares;
}

}  // namespace tetwarp::reference

/// @file body_points.cpp
/// Positions, shares and bindings of material points.
#include "host/simulate/model/body_points.hpp"

#include <numeric>

#include "host/base/index_of.hpp"
#include "host/simulate/model/nearest.hpp"
#include "host/simulate/model/rotations.hpp"
#include "host/simulate/model/state_view.hpp"

namespace tetwarp {
namespace {

void add_area_thirds(const std::vector<Point3>& points,
                     const std::vector<std::array<std::int32_t, 3>>& triangles,
                     std::vector<double>& shares) {
  for (const auto& triangle : triangles) {
    const Point3 normal = cross(minus(at(points, triangle[1]), at(points, triangle[0])),
                                minus(at(points, triangle[2]), at(points, triangle[0])));
    for (const std::int32_t point : triangle) shares[index_of(point)] += norm(normal) / 6;
  }
}

}  // namespace

Point3 position_of(const ModelPoint& point, const ModelState& state, std::int32_t node_count) {
  Point3 x;
  start_of(point, view_of_state(state, node_count), x.data());
  return x;
}

ModelPoint selected_point(const Model& model,
                          const SceneGeometry& geometry,
                          std::int32_t body,
                          std::int32_t index) {
  const BodyGeometry& of = geometry.bodies[index_of(body)];
  ModelPoint point;
  point.body = body;
  if (!of.nodes.empty()) {
    point.node[0] = at(model.body_node, body) + index;
    point.weight[0] = 1;
    return point;
  }
  point.rigid = at(model.body_rigid, body);
  const Point3 arm = minus(at(of.surface.points, index), at(model.rigid.center, point.rigid));
  point.local = rotate(conjugate(at(model.rigid.axes, point.rigid)), arm);
  return point;
}

std::vector<double> shares_of(const BodyGeometry& geometry,
                              const std::vector<std::int32_t>& selected) {
  const bool has_nodes = !geometry.nodes.empty();
  std::vector<double> all(has_nodes ? geometry.nodes.size() : geometry.surface.points.size(), 0.0);
  for (const auto& tet : geometry.tets) {
    const double volume = tet_volume(at(geometry.nodes, tet[0]), at(geometry.nodes, tet[1]),
                                     at(geometry.nodes, tet[2]), at(geometry.nodes, tet[3]));
    for (const std::int32_t node : tet) all[index_of(node)] += volume / 4;
  }
  if (has_nodes && geometry.tets.empty()) {
    const bool is_cloth = !geometry.cloth_triangles.empty();
    add_area_thirds(geometry.nodes,
                    is_cloth ? geometry.cloth_triangles : geometry.surface.triangles, all);
  } else if (!has_nodes) {
    add_area_thirds(geometry.surface.points, geometry.surface.triangles, all);
  }
  std::vector<double> shares;
  shares.reserve(selected.size());
  for (const std::int32_t i : selected) shares.push_back(all[index_of(i)]);
  double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  if (!(sum > 0)) {
    shares.assign(shares.size(), 1);
    sum = static_cast<double>(shares.size());
  }
  for (double& share : shares) share /= sum;
  return shares;
}

std::vector<ModelPoint> bound_surface(const Model& model,
                                      const SceneGeometry& geometry,
                                      std::int32_t body) {
  const BodyGeometry& of = geometry.bodies[index_of(body)];
  std::vector<ModelPoint> points;
  points.reserve(of.surface.points.size());
  if (of.tets.empty() || !of.surface_node.empty()) {
    for (std::size_t p = 0; p < of.surface.points.size(); ++p) {
      const std::int32_t index =
          of.surface_node.empty() ? static_cast<std::int32_t>(p) : of.surface_node[p];
      points.push_back(selected_point(model, geometry, body, index));
    }
    return points;
  }
  const NearestItems<4> search(of.nodes, of.tets);
  for (const Point3& x : of.surface.points) {
    const NearestPoint<4> found = search.find(x);
    ModelPoint point;
    point.body = body;
    for (std::size_t a = 0; a < 4; ++a) {
      point.node[a] = at(model.body_node, body) + at(of.tets, found.item)[a];
      point.weight[a] = found.weight[a];
    }
    points.push_back(point);
  }
  return points;
}

}  // namespace tetwarp

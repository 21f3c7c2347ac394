/// @file nearest_material.cpp
/// Searches all triangles or tetrahedra of a body, or the shape of an obstacle.
#include "host/reference/simulate/nearest_material.hpp"

#include <limits>
#include <stdexcept>

#include "host/reference/simulate/make_system.hpp"

namespace tetwarp::reference {
namespace {

/// Nearest of simplices of `size` corners; ties go to the first.
template <std::size_t size>
NearestMaterial nearest_of(const std::vector<std::array<std::int32_t, size>>& simplices,
                           const std::vector<Vector3d>& points,
                           const Vector3d& x) {
  NearestMaterial result{{}, std::numeric_limits<double>::infinity()};
  for (const auto& simplex : simplices) {
    MatrixXd corners(3, size);
    for (std::size_t c = 0; c < size; ++c) {
      corners.col(static_cast<Eigen::Index>(c)) = points[static_cast<std::size_t>(simplex[c])];
    }
    const Vector3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
    const double to_box = (x - x.cwiseMax(low).cwiseMin(high)).norm();
    if (to_box >= result.distance) continue;
    const NearestPoint nearest = nearest_of_simplex(corners, x);
    if (nearest.distance >= result.distance) continue;
    result.distance = nearest.distance;
    result.point.nodes.assign(simplex.begin(), simplex.end());
    result.point.weights.assign(nearest.weights.data(), nearest.weights.data() + size);
    result.point.local = corners * nearest.weights;
  }
  return result;
}

/// Of a solid bounded by a surface, in the frame of its geometry; the point itself within.
NearestMaterial nearest_of_solid(const Surface& surface, const Vector3d& x) {
  std::vector<Vector3d> points;
  for (const Point3& p : surface.points) points.push_back(vector_of(p));
  if (surface.triangles.empty() || is_enclosed(surface.triangles, points, x)) {
    return {{-1, {}, {}, -1, x}, 0};
  }
  NearestMaterial nearest = nearest_of(surface.triangles, points, x);
  nearest.point.nodes.clear();
  nearest.point.weights.clear();
  return nearest;
}

Vector3d nearest_of_ball(const Vector3d& center, double radius, const Vector3d& x) {
  const double distance = (x - center).norm();
  if (distance <= radius) return x;
  return center + radius / distance * (x - center);
}

Vector3d nearest_of_obstacle(const Obstacle& obstacle, const Vector3d& x) {
  if (const auto* plane = std::get_if<PlaneObstacle>(&obstacle.geometry)) {
    const Vector3d normal = vector_of(plane->normal).normalized();
    const double height = normal.dot(x - vector_of(plane->point));
    return height <= 0 ? x : x - height * normal;
  }
  if (const auto* sphere = std::get_if<SphereObstacle>(&obstacle.geometry)) {
    return nearest_of_ball(vector_of(sphere->center), sphere->radius, x);
  }
  if (const auto* capsule = std::get_if<CapsuleObstacle>(&obstacle.geometry)) {
    MatrixXd ends(3, 2);
    ends << vector_of(capsule->from), vector_of(capsule->to);
    return nearest_of_ball(ends * nearest_of_simplex(ends, x).weights, capsule->radius, x);
  }
  return nearest_of_solid(std::get<Surface>(obstacle.geometry), x).point.local;
}

NearestMaterial nearest_of_body(int body,
                                const Vector3d& x,
                                const State& start,
                                const System& system) {
  const auto b = static_cast<std::size_t>(body);
  const BodyGeometry& geometry = system.geometry.bodies[b];
  const BodyPlace& place = system.places[b];
  NearestMaterial nearest;
  if (place.node_count > 0) {
    const auto first = start.node.begin() + place.first_node;
    const std::vector<Vector3d> nodes(first, first + place.node_count);
    if (!geometry.tets.empty()) {
      nearest = nearest_of(geometry.tets, nodes, x);
    } else {
      const auto& triangles =
          geometry.cloth_triangles.empty() ? geometry.surface.triangles : geometry.cloth_triangles;
      nearest = nearest_of(triangles, nodes, x);
    }
    for (int& node : nearest.point.nodes) node += place.first_node;
  } else {
    const auto r = static_cast<std::size_t>(place.rigid);
    const Vector3d center = system.rigids[r].center;
    const Placement& frame = start.frame[r];
    const Vector3d local = frame.rotation.transpose() * (x - frame.position) + center;
    nearest = nearest_of_solid(geometry.surface, local);
    nearest.point.rigid = place.rigid;
    nearest.point.local -= center;
  }
  nearest.point.body = body;
  return nearest;
}

}  // namespace

int obstacle_frame(System& system, int obstacle) {
  const int body = static_cast<int>(system.scene.bodies.size()) + obstacle;
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    if (system.rigids[r].body == body) return static_cast<int>(r);
  }
  RigidBody frame;
  frame.body = body;
  system.rigids.push_back(frame);
  return static_cast<int>(system.rigids.size()) - 1;
}

NearestMaterial nearest_material(const std::string& name,
                                 const Vector3d& x,
                                 const State& start,
                                 const System& system) {
  for (std::size_t b = 0; b < system.scene.bodies.size(); ++b) {
    if (system.scene.bodies[b].name == name) {
      return nearest_of_body(static_cast<int>(b), x, start, system);
    }
  }
  NearestMaterial nearest;
  nearest.point.local = x;
  if (name == "world") return nearest;
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    const int obstacle = system.rigids[r].body - static_cast<int>(system.scene.bodies.size());
    if (obstacle < 0) continue;
    const Obstacle& of = system.scene.obstacles[static_cast<std::size_t>(obstacle)];
    if (of.name != name) continue;
    const Placement& frame = start.frame[r];
    const Vector3d local = frame.rotation.transpose() * (x - frame.position);
    nearest.point.rigid = static_cast<int>(r);
    nearest.point.body = system.rigids[r].body;
    nearest.point.local = nearest_of_obstacle(of, local);
    nearest.distance = (nearest.point.local - local).norm();
    return nearest;
  }
  throw std::invalid_argument("no body, obstacle or world is named " + name);
}

MaterialPoint tied_point(const std::string& name,
                         const Vector3d& x,
                         const State& start,
                         const System& system) {
  MaterialPoint point = nearest_material(name, x, start, system).point;
  if (point.rigid < 0) return point;
  const auto r = static_cast<std::size_t>(point.rigid);
  point.local = start.frame[r].rotation.transpose() * (x - start.frame[r].position);
  return point;
}

}  // namespace tetwarp::reference

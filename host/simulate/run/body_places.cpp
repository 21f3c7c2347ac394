/// @file body_places.cpp
/// Places and meshes of bodies from the state after the last step.
#include "host/simulate/run/body_places.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "host/base/index_of.hpp"
#include "host/base/point3.hpp"
#include "host/simulate/model/body_points.hpp"

namespace tetwarp {
namespace {

double mass_of(const Model& model, std::size_t body) {
  const std::int32_t rigid = model.body_rigid[body];
  if (rigid >= 0) return at(model.rigid.mass, rigid);
  double mass = 0;
  for (std::int32_t n = model.body_node[body]; n < model.body_node[body + 1]; ++n) {
    mass += at(model.node_mass, n);
  }
  return mass;
}

BodyMesh mesh_of(const SimulatedScene& scene, std::size_t body) {
  const Model& model = scene.model;
  const BodyGeometry& of = scene.geometry.bodies[body];
  BodyMesh mesh;
  mesh.kind = scene.scene.bodies[body].kind;
  mesh.mass = mass_of(model, body);
  mesh.cells_across = of.cells_across;
  mesh.foreground_volume = model.body_foreground[body];
  mesh.uncovered_volume = std::max(0.0, model.body_foreground[body] - model.body_covered[body]);
  mesh.mesh = {of.nodes, of.tets};
  mesh.surface = of.surface;
  for (std::size_t t = 0; t < model.tets.nodes.size(); ++t) {
    const std::int32_t node = model.tets.nodes[t][0];
    if (node >= model.body_node[body] && node < model.body_node[body + 1]) {
      mesh.shear_modulus.push_back(model.tets.mu[t]);
    }
  }
  return mesh;
}

/// The part of a list of nodes that belongs to a body.
std::vector<Point3> nodes_of(const Model& model,
                             std::size_t body,
                             const std::vector<Point3>& list) {
  return {list.begin() + model.body_node[body], list.begin() + model.body_node[body + 1]};
}

}  // namespace

BodyPlaces::BodyPlaces(const SimulatedScene& scene, const StepCount& count, MovingBodies& bodies)
    : scene_(scene),
      count_(count),
      bodies_(bodies),
      surfaces_(scene.scene.bodies.size()),
      scripted_positions_(scene.scene.bodies.size()) {
  for (std::size_t b = 0; b < surfaces_.size(); ++b) meshes_.push_back(mesh_of(scene, b));
}

void BodyPlaces::check(std::size_t body) const {
  if (body < meshes_.size()) return;
  throw std::invalid_argument("body " + std::to_string(body) + ": the scene has " +
                              std::to_string(meshes_.size()) + " bodies, counted from 0");
}

bool BodyPlaces::is_scripted(std::size_t body) const {
  return scene_.scene.bodies[body].kind == BodyKind::scripted;
}

const BodyMesh& BodyPlaces::mesh(std::size_t body) const {
  check(body);
  return meshes_[body];
}

PositionsView BodyPlaces::positions(std::size_t body) {
  check(body);
  if (is_scripted(body)) return scripted_positions_[body] = node_positions(body);
  const std::int32_t first = scene_.model.body_node[body];
  return bodies_.stepper().positions(first, scene_.model.body_node[body + 1] - first);
}

std::vector<Point3> BodyPlaces::node_positions(std::size_t body) {
  check(body);
  // A script that was stopped is between two places of its path. One that was moved by
  // Simulator::move_script() has its new place after the next step.
  const SceneDrive& drive = bodies_.drive();
  const bool is_on_path = drive.state().delays[body] == 0 && !drive.overrides().scripts[body];
  if (is_scripted(body) && is_on_path) return drive.scripted_positions(body, count_.time());
  return nodes_of(scene_.model, body, bodies_.state().get().position);
}

std::vector<Point3> BodyPlaces::node_velocities(std::size_t body) {
  check(body);
  return nodes_of(scene_.model, body, bodies_.state().get().velocity);
}

const std::vector<ModelPoint>& BodyPlaces::surface(std::size_t body) {
  std::vector<ModelPoint>& points = surfaces_[body];
  if (points.empty()) {
    points = bound_surface(scene_.model, scene_.geometry, static_cast<std::int32_t>(body));
  }
  return points;
}

std::vector<Point3> BodyPlaces::surface_positions(std::size_t body) {
  check(body);
  const std::int32_t node_count = scene_.model.node_count;
  ModelState scripted;  // with the nodes of the body alone
  if (is_scripted(body)) {
    const std::vector<Point3> nodes = node_positions(body);
    scripted.position.resize(index_of(scene_.model.body_node[body]));
    scripted.position.insert(scripted.position.end(), nodes.begin(), nodes.end());
  }
  std::vector<Point3> positions;
  for (const ModelPoint& point : surface(body)) {
    const bool is_in_state = !is_scripted(body) || point.rigid >= 0;
    positions.push_back(
        position_of(point, is_in_state ? bodies_.state().get() : scripted, node_count));
  }
  return positions;
}

}  // namespace tetwarp

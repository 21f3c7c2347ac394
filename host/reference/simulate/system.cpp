/// @file system.cpp
/// Positions and Jacobians of material points; parts of a scene by name.
#include "host/reference/simulate/system.hpp"

#include <stdexcept>

namespace tetwarp::reference {

Matrix3d inertia_of(const RigidBody& rigid, const Matrix3d& rotation) {
  return rotation * rigid.inertia * rotation.transpose();
}

Vector3d position_of(const System&, const State& state, const MaterialPoint& point) {
  if (point.rigid >= 0) return state.frame[static_cast<std::size_t>(point.rigid)](point.local);
  if (point.nodes.empty()) return point.local;
  Vector3d sum = Vector3d::Zero();
  for (std::size_t a = 0; a < point.nodes.size(); ++a) {
    sum += point.weights[a] * state.node[static_cast<std::size_t>(point.nodes[a])];
  }
  return sum;
}

std::vector<PointBlock> jacobian_of(const System& system,
                                    const State& state,
                                    const MaterialPoint& point) {
  if (point.rigid >= 0) {
    const Placement& frame = state.frame[static_cast<std::size_t>(point.rigid)];
    const int block = system.linear_block(point.rigid);
    return {{block, Matrix3d::Identity()},
            {block + 1, -cross_matrix(frame.rotation * point.local)}};
  }
  std::vector<PointBlock> blocks;
  for (std::size_t a = 0; a < point.nodes.size(); ++a) {
    blocks.push_back({point.nodes[a], point.weights[a] * Matrix3d::Identity()});
  }
  return blocks;
}

int body_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name) return static_cast<int>(b);
  }
  throw std::invalid_argument("no body is named " + name);
}

std::size_t handle_named(const Scene& scene, const std::string& name) {
  for (std::size_t h = 0; h < scene.handles.size(); ++h) {
    const Handle& handle = scene.handles[h];
    if ((handle.name.empty() ? handle.body : handle.name) == name) return h;
  }
  throw std::invalid_argument("no handle is named " + name);
}

std::size_t script_named(const Scene& scene, const std::string& name) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (scene.bodies[b].name == name && scene.bodies[b].kind == BodyKind::scripted) return b;
  }
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    if (scene.obstacles[o].name == name) return scene.bodies.size() + o;
  }
  throw std::invalid_argument("no scripted body or obstacle is named " + name);
}

}  // namespace tetwarp::reference

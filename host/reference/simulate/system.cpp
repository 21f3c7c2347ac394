/// @file system.cpp
/// Positions and Jacobians of material points.
#include "host/reference/simulate/system.hpp"

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

}  // namespace tetwarp::reference

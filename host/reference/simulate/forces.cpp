/// @file forces.cpp
/// Sums of forces by block.

#include "host/reference/simulate/forces.hpp"

namespace tetwarp::reference {

Matrix34 positions_of(const Element& element, const State& state) {
  Matrix34 positions;
  for (int a = 0; a < 4; ++a) {
    const auto node = static_cast<std::size_t>(element.nodes[static_cast<std::size_t>(a)]);
    positions.col(a) = state.node[node];
  }
  return positions;
}

VectorXd elastic_force(const System& system, const State& state) {
  VectorXd force = VectorXd::Zero(3 * system.block_count());
  const auto at = [&](int block) { return force.segment<3>(3 * block); };
  for (const Element& element : system.elements) {
    const Matrix34 f = element_force(element, positions_of(element, state));
    for (int a = 0; a < 4; ++a) at(element.nodes[static_cast<std::size_t>(a)]) += f.col(a);
  }
  for (const EdgeSpring& edge : system.edges) {
    const auto [a, b] = edge.nodes;
    const Vector3d f = spring_force(
        edge, state.node[static_cast<std::size_t>(a)] - state.node[static_cast<std::size_t>(b)]);
    at(a) += f;
    at(b) -= f;
  }
  for (int a = 0; a < system.node_count(); ++a) {
    for (int b = 0; b < system.node_count(); ++b) {
      at(a) -= system.bend(a, b) * state.node[static_cast<std::size_t>(b)];
    }
  }
  return force;
}

VectorXd load_force(const System& system, const State& state, std::size_t l, double end_time) {
  VectorXd force = VectorXd::Zero(3 * system.block_count());
  const Load& load = system.scene.loads[l];
  const LoadPlace& place = system.loads[l];
  if (is_reached(end_time, load.from) || !is_reached(end_time, load.to)) return force;
  const auto push = [&](const MaterialPoint& point, const Vector3d& f) {
    for (const auto& [block, matrix] : jacobian_of(system, state, point)) {
      force.segment<3>(3 * block) += matrix.transpose() * f;
    }
  };
  if (load.force) {
    for (std::size_t i = 0; i < place.points.size(); ++i) {
      push(place.points[i], place.shares[i] * vector_of(*load.force));
    }
    return force;
  }
  for (const auto& triangle : place.triangles) {
    std::array<Vector3d, 3> x;
    for (std::size_t c = 0; c < 3; ++c) {
      x[c] = position_of(system, state, place.points[static_cast<std::size_t>(triangle[c])]);
    }
    const Vector3d area = (x[1] - x[0]).cross(x[2] - x[0]) / 2;
    for (const int c : triangle) {
      push(place.points[static_cast<std::size_t>(c)], -*load.pressure / 3 * area);
    }
  }
  return force;
}

}  // namespace tetwarp::reference

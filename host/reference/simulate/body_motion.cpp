/// @file body_motion.cpp
/// Sums over the nodes of a body, or the state of its rigid frame.
#include "host/reference/simulate/body_motion.hpp"

namespace tetwarp::reference {

namespace {

/// Mass matrix of a body's nodes against 1, x and v: sums over pairs of nodes.
BodyMotion motion_of_nodes(const System& system, const State& state, const BodyPlace& place) {
  BodyMotion motion;
  const int end = place.first_node + place.node_count;
  const auto at = [](const std::vector<Vector3d>& of, int n) -> const Vector3d& {
    return of[static_cast<std::size_t>(n)];
  };
  for (int a = place.first_node; a < end; ++a) {
    for (int b = place.first_node; b < end; ++b) {
      motion.mass += system.mass(a, b);
      motion.center += system.mass(a, b) * at(state.node, b);
      motion.velocity += system.mass(a, b) * at(state.velocity, b);
    }
  }
  if (motion.mass == 0) {  // scripted: means of the nodes
    for (int n = place.first_node; n < end; ++n) {
      motion.center += at(state.node, n) / place.node_count;
      motion.velocity += at(state.velocity, n) / place.node_count;
    }
    return motion;
  }
  motion.center /= motion.mass;
  motion.velocity /= motion.mass;
  for (int a = place.first_node; a < end; ++a) {
    const Vector3d arm = at(state.node, a) - motion.center;
    for (int b = place.first_node; b < end; ++b) {
      const Vector3d other = at(state.node, b) - motion.center;
      motion.angular_momentum += system.mass(a, b) * arm.cross(at(state.velocity, b));
      motion.inertia +=
          system.mass(a, b) * (arm.dot(other) * Matrix3d::Identity() - other * arm.transpose());
    }
  }
  return motion;
}

}  // namespace

BodyMotion motion_of(const System& system, const State& state, std::size_t body) {
  const BodyPlace& place = system.places.at(body);
  if (place.rigid < 0) return motion_of_nodes(system, state, place);
  const auto r = static_cast<std::size_t>(place.rigid);
  const auto block = static_cast<std::size_t>(system.linear_block(place.rigid));
  return {system.rigids[r].mass, state.frame[r].position, state.velocity[block],
          state.angular_momentum[r], inertia_of(system.rigids[r], state.frame[r].rotation)};
}

}  // namespace tetwarp::reference

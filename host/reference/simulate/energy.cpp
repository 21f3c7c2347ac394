/// @file energy.cpp
/// Sums of kinetic, elastic and potential energy, and of work.
#include "host/reference/simulate/energy.hpp"

#include "host/reference/simulate/body_motion.hpp"
#include "host/reference/simulate/forces.hpp"

namespace tetwarp::reference {
namespace {

double kinetic_energy(const System& system, const State& state) {
  double energy = 0;
  for (int a = 0; a < system.node_count(); ++a) {
    for (int b = 0; b < system.node_count(); ++b) {
      energy += system.mass(a, b) / 2 *
                state.velocity[static_cast<std::size_t>(a)].dot(
                    state.velocity[static_cast<std::size_t>(b)]);
    }
  }
  for (std::size_t r = 0; r < system.rigids.size(); ++r) {
    if (system.rigids[r].mass == 0) continue;
    const auto block = static_cast<std::size_t>(system.linear_block(static_cast<int>(r)));
    energy += system.rigids[r].mass / 2 * state.velocity[block].squaredNorm() +
              state.velocity[block + 1].dot(state.angular_momentum[r]) / 2;
  }
  return energy;
}

double elastic_energy(const System& system, const State& state, const Prescribed& prescribed) {
  double energy = 0;
  for (const Element& element : system.elements) {
    energy += element_energy(element, positions_of(element, state));
  }
  for (const EdgeSpring& edge : system.edges) {
    const Vector3d line = state.node[static_cast<std::size_t>(edge.nodes[0])] -
                          state.node[static_cast<std::size_t>(edge.nodes[1])];
    energy += edge.stiffness / 2 * std::pow(line.norm() - edge.rest_length, 2);
  }
  for (int a = 0; a < system.node_count(); ++a) {
    for (int b = 0; b < system.node_count(); ++b) {
      energy +=
          system.bend(a, b) / 2 *
          state.node[static_cast<std::size_t>(a)].dot(state.node[static_cast<std::size_t>(b)]);
    }
  }
  for (const BindingSpring& spring : system.springs) {
    Vector3d end = position_of(system, state, spring.b);
    if (spring.handle >= 0) {
      const auto& displacement = prescribed.handles[static_cast<std::size_t>(spring.handle)];
      if (!displacement) continue;
      end += *displacement;
    }
    energy += spring.stiffness / 2 * (position_of(system, state, spring.a) - end).squaredNorm();
  }
  return energy;
}

}  // namespace

SceneEnergy energy_of(const System& system, const State& state, const Prescribed& prescribed) {
  SceneEnergy energy;
  energy.kinetic = kinetic_energy(system, state);
  energy.elastic = elastic_energy(system, state, prescribed);
  const Vector3d gravity = vector_of(system.scene.gravity);
  for (std::size_t b = 0; b < system.places.size(); ++b) {
    const BodyMotion motion = motion_of(system, state, b);
    energy.gravity -= motion.mass * gravity.dot(motion.center);
  }
  return energy;
}

double work_of(const System& system, const StepDrive& drive, const StepResult& result) {
  double work = result.support.dot(result.velocity);
  for (const VectorXd& load : result.loads) work += load.dot(result.velocity);
  for (std::size_t s = 0; s < system.springs.size(); ++s) {
    if (system.springs[s].handle < 0) continue;
    const auto h = static_cast<std::size_t>(system.springs[s].handle);
    const auto &before = drive.before.handles[h], &after = drive.after.handles[h];
    if (!before || !after) continue;
    work += result.spring_impulse[s].dot((*after - *before) / drive.time_step);
  }
  return work;
}

}  // namespace tetwarp::reference

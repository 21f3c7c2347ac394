#include <algorithm>

#include "host/reference/simulate/bodies_parts.hpp"

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
      motion.centre += system.mass(a, b) * at(state.node, b);
      motion.velocity += system.mass(a, b) * at(state.velocity, b);
    }
  }
  if (motion.mass == 0) {  // scripted: means of the nodes
    for (int n = place.first_node; n < end; ++n) {
      motion.centre += at(state.node, n) / place.node_count;
      motion.velocity += at(state.velocity, n) / place.node_count;
    }
    return motion;
  }
  motion.centre /= motion.mass;
  motion.velocity /= motion.mass;
  for (int a = place.first_node; a < end; ++a) {
    const Vector3d arm = at(state.node, a) - motion.centre;
    for (int b = place.first_node; b < end; ++b) {
      const Vector3d other = at(state.node, b) - motion.centre;
      motion.angular_momentum += system.mass(a, b) * arm.cross(at(state.velocity, b));
      motion.inertia +=
          system.mass(a, b) * (arm.dot(other) * Matrix3d::Identity() - other * arm.transpose());
    }
  }
  return motion;
}

Vector3d sum_of_blocks(const System& system, const BodyPlace& place, const VectorXd& impulse) {
  if (place.rigid >= 0) return impulse.segment<3>(3 * system.linear_block(place.rigid));
  Vector3d sum = Vector3d::Zero();
  for (int n = place.first_node; n < place.first_node + place.node_count; ++n) {
    sum += impulse.segment<3>(3 * n);
  }
  return sum;
}

void add_to(Point3& sum, const Vector3d& part) {
  sum = point_of(vector_of(sum) + part);
}

/// Forces of the last step on bodies, obstacles and couplings.
void record_forces(const System& system, const StepResult& last, StepRecord& record) {
  const double per_time = 1 / system.scene.time_step;
  const std::size_t body_count = system.scene.bodies.size();
  for (std::size_t b = 0; b < body_count; ++b) {
    const BodyPlace& place = system.places[b];
    BodyRecord& of = record.bodies[b];
    add_to(of.support_force, per_time * sum_of_blocks(system, place, last.support));
    for (const VectorXd& load : last.loads) {
      add_to(of.load_force, per_time * sum_of_blocks(system, place, load));
    }
  }
  for (std::size_t s = 0; s < system.springs.size(); ++s) {
    const BindingSpring& spring = system.springs[s];
    const Vector3d force = per_time * last.spring_impulse[s];
    const auto end = [&](const MaterialPoint& point, const Vector3d& on) {
      if (point.body < 0) return;
      const auto b = static_cast<std::size_t>(point.body);
      if (b >= body_count) return;
      add_to(spring.handle >= 0 ? record.bodies[b].handle_force : record.bodies[b].coupling_force,
             on);
    };
    end(spring.a, force);
    end(spring.b, -force);
    if (spring.coupling >= 0) {
      add_to(record.coupling_forces[static_cast<std::size_t>(spring.coupling)], force);
    }
  }
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

StepRecord ReferenceBodies::record() const {
  const System& system = parts_->system;
  const State& state = parts_->state;
  StepRecord record;
  record.time = time();
  record.energy = energy_of(system, state, parts_->prescribed);
  record.energy.work = parts_->work;
  record.bodies.resize(system.scene.bodies.size());
  record.obstacle_forces.resize(system.scene.obstacles.size());
  record.coupling_forces.resize(system.scene.couplings.size());
  for (std::size_t b = 0; b < record.bodies.size(); ++b) {
    const BodyMotion motion = motion_of(system, state, b);
    const Vector3d momentum = motion.mass * motion.velocity;
    BodyRecord& of = record.bodies[b];
    of.centre = point_of(motion.centre);
    of.velocity = point_of(motion.velocity);
    of.angular_momentum = point_of(motion.angular_momentum);
    add_to(record.momentum, momentum);
    add_to(record.angular_momentum, motion.centre.cross(momentum) + motion.angular_momentum);
    if (system.places[b].rigid < 0) continue;
    const int block = system.linear_block(system.places[b].rigid) + 1;
    of.rotation =
        quaternion_of(state.frame[static_cast<std::size_t>(system.places[b].rigid)].rotation);
    of.angular_velocity = point_of(state.velocity[static_cast<std::size_t>(block)]);
  }
  for (const Element& element : system.elements) {
    const Matrix3d deformation = positions_of(element, state) * element.gradients.transpose();
    record.inverted += deformation.determinant() < 0;
  }
  if (parts_->last) record_forces(system, *parts_->last, record);
  return record;
}

}  // namespace tetwarp::reference

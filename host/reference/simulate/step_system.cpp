/// @file step_system.cpp
/// Solves for the unknown velocities, and moves the state by them.
#include "host/reference/simulate/step_system.hpp"

#include "host/reference/simulate/assemble.hpp"
#include "host/reference/simulate/forces.hpp"

namespace tetwarp::reference {
namespace {

/// Velocities that take what is prescribed to where it is at the end of the step; others are zero.
VectorXd prescribed_velocity(const System& system, const State& state, const StepDrive& drive) {
  VectorXd velocity = VectorXd::Zero(3 * system.block_count());
  for (std::size_t n = 0; n < state.node.size(); ++n) {
    const auto& target = drive.after.nodes[n];
    if (target) {
      velocity.segment<3>(3 * static_cast<Eigen::Index>(n)) =
          (*target - state.node[n]) / drive.time_step;
    }
  }
  for (std::size_t r = 0; r < state.frame.size(); ++r) {
    const auto& target = drive.after.frames[r];
    if (!target) continue;
    const int linear = system.linear_block(static_cast<int>(r));
    const Matrix3d turn = target->rotation * state.frame[r].rotation.transpose();
    velocity.segment<3>(3 * linear) =
        (target->position - state.frame[r].position) / drive.time_step;
    velocity.segment<3>(3 * linear + 3) = axis_angle_of(turn) / drive.time_step;
  }
  return velocity;
}

/// Solves the rows of the unknown velocities for them, the others given.
VectorXd solve(const System& system, const LinearSystem& linear, VectorXd velocity) {
  std::vector<int> rows;
  for (int block = 0; block < system.block_count(); ++block) {
    if (system.is_prescribed[static_cast<std::size_t>(block)]) continue;
    for (int axis = 0; axis < 3; ++axis) rows.push_back(3 * block + axis);
  }
  if (rows.empty()) return velocity;
  const VectorXd right = linear.right - linear.matrix * velocity;
  const MatrixXd matrix = linear.matrix(rows, rows);
  const auto factors = matrix.ldlt();
  VectorXd solution = factors.solve(right(rows));
  solution += factors.solve(right(rows) - matrix * solution);
  velocity(rows) = solution;
  return velocity;
}

}  // namespace

VectorXd solve_step(const System& system,
                    const State& state,
                    const StepDrive& drive,
                    const LinearSystem& linear) {
  return solve(system, linear, prescribed_velocity(system, state, drive));
}

VectorXd support_of(const System& system, const LinearSystem& linear, const VectorXd& velocity) {
  VectorXd support = linear.matrix * velocity - linear.right;
  for (int block = 0; block < system.block_count(); ++block) {
    if (!system.is_prescribed[static_cast<std::size_t>(block)]) {
      support.segment<3>(3 * block).setZero();
    }
  }
  return support;
}

State moved_by(const System& system,
               const State& before,
               const StepDrive& drive,
               const VectorXd& velocity,
               std::span<const double> fraction) {
  State state = before;
  const auto share_of = [&](std::size_t body) { return fraction.empty() ? 1 : fraction[body]; };
  const auto at = [&](int block) -> Vector3d { return velocity.segment<3>(3 * block); };
  for (int block = 0; block < system.block_count(); ++block) {
    state.velocity[static_cast<std::size_t>(block)] = at(block);
  }
  for (std::size_t b = 0; b < system.places.size(); ++b) {
    const BodyPlace& place = system.places[b];
    const double share = share_of(b);
    for (int i = place.first_node; i < place.first_node + place.node_count; ++i) {
      const auto n = static_cast<std::size_t>(i);
      state.node[n] += share * drive.time_step * at(i);
      if (drive.after.nodes[n] && share == 1) state.node[n] = *drive.after.nodes[n];
    }
  }
  for (std::size_t r = 0; r < state.frame.size(); ++r) {
    const int linear = system.linear_block(static_cast<int>(r));
    Placement& frame = state.frame[r];
    const RigidBody& rigid = system.rigids[r];
    const double share = share_of(static_cast<std::size_t>(rigid.body));
    const Matrix3d start = frame.rotation;
    frame.position += share * drive.time_step * at(linear);
    frame.rotation = turn_of(share * drive.time_step * at(linear + 1)) * frame.rotation;
    frame.rotation = rotation_of(quaternion_of(frame.rotation));
    if (drive.after.frames[r]) {
      if (share == 1) frame = *drive.after.frames[r];
      continue;
    }
    const Matrix3d middle =
        midpoint_rotation(rigid, start, before.angular_momentum[r], drive.time_step);
    state.angular_momentum[r] = inertia_of(rigid, middle) * at(linear + 1);
    state.velocity[static_cast<std::size_t>(linear) + 1] =
        inertia_of(rigid, frame.rotation).llt().solve(state.angular_momentum[r]);
  }
  return state;
}

StepResult step_once(const System& system, const State& state, const StepDrive& drive) {
  const LinearSystem linear = assemble(system, state, drive);
  StepResult result;
  result.velocity = solve_step(system, state, drive, linear);
  result.support = support_of(system, linear, result.velocity);
  for (std::size_t l = 0; l < system.loads.size(); ++l) {
    result.loads.push_back(drive.time_step * load_force(system, state, l, drive.end_time));
  }
  for (const BindingSpring& spring : system.springs) {
    Vector3d impulse = Vector3d::Zero();
    if (const auto pull = pull_of(system, state, drive, spring)) {
      impulse = pull->constant;
      for (const auto& [block, matrix] : pull->jacobian) {
        impulse -= pull->weight * (matrix * result.velocity.segment<3>(3 * block));
      }
    }
    result.spring_impulse.push_back(impulse);
  }
  result.state = moved_by(system, state, drive, result.velocity, {});
  return result;
}

}  // namespace tetwarp::reference

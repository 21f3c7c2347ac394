/// @file assemble.cpp
/// Adds up A and b from masses, elements, edges, rigid bodies and springs.
#include "host/reference/simulate/assemble.hpp"

#include "host/reference/simulate/forces.hpp"

namespace tetwarp::reference {
namespace {

class Assembly {
 public:
  Assembly(const System& system, const State& state, const StepDrive& drive)
      : system_(system), state_(state), drive_(drive), dt_(drive.time_step) {
    const int size = 3 * system.block_count();
    result_.matrix = MatrixXd::Zero(size, size);
    result_.right = VectorXd::Zero(size);
  }

  LinearSystem run() {
    add_node_masses();
    add_elements();
    add_edges();
    add_rigids();
    add_springs();
    result_.right += dt_ * elastic_force(system_, state_);
    for (std::size_t l = 0; l < system_.loads.size(); ++l) {
      result_.right += dt_ * load_force(system_, state_, l, drive_.end_time);
    }
    return std::move(result_);
  }

 private:
  auto block(int a, int b) { return result_.matrix.block<3, 3>(3 * a, 3 * b); }
  auto right(int a) { return result_.right.segment<3>(3 * a); }

  /// A += (1 + dt alpha) M + (dt^2 + dt gamma) bend, b += M v + dt m g.
  void add_node_masses() {
    const Vector3d gravity = vector_of(system_.scene.gravity);
    for (int a = 0; a < system_.node_count(); ++a) {
      for (int b = 0; b < system_.node_count(); ++b) {
        const double scalar = system_.mass(a, b) + dt_ * system_.mass_alpha(a, b) +
                              dt_ * dt_ * system_.bend(a, b) + dt_ * system_.bend_gamma(a, b);
        block(a, b) += scalar * Matrix3d::Identity();
        right(a) +=
            system_.mass(a, b) * (state_.velocity[static_cast<std::size_t>(b)] + dt_ * gravity);
      }
    }
  }

  void add_elements() {
    for (std::size_t e = 0; e < system_.elements.size(); ++e) {
      const Element& element = system_.elements[e];
      const auto stiffness = element_stiffness(element, positions_of(element, state_));
      const double factor = dt_ * dt_ + dt_ * system_.element_gamma[e];
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          block(element.nodes[static_cast<std::size_t>(a)],
                element.nodes[static_cast<std::size_t>(b)]) +=
              factor * stiffness.block<3, 3>(3 * a, 3 * b);
        }
      }
    }
  }

  void add_edges() {
    for (const EdgeSpring& edge : system_.edges) {
      const auto [a, b] = edge.nodes;
      const Vector3d line =
          state_.node[static_cast<std::size_t>(a)] - state_.node[static_cast<std::size_t>(b)];
      const Matrix3d k = (dt_ * dt_ + dt_ * edge.gamma) * spring_stiffness(edge, line);
      block(a, a) += k;
      block(b, b) += k;
      block(a, b) -= k;
      block(b, a) -= k;
    }
  }

  /// A += (1 + dt alpha) diag(m 1, I_m), b += (m v + dt m g, L).
  void add_rigids() {
    for (std::size_t r = 0; r < system_.rigids.size(); ++r) {
      const RigidBody& rigid = system_.rigids[r];
      if (rigid.mass == 0) continue;
      const int linear = system_.linear_block(static_cast<int>(r));
      const Matrix3d middle =
          midpoint_rotation(rigid, state_.frame[r].rotation, state_.angular_momentum[r], dt_);
      const double damped = 1 + dt_ * rigid.alpha;
      block(linear, linear) += damped * rigid.mass * Matrix3d::Identity();
      block(linear + 1, linear + 1) += damped * inertia_of(rigid, middle);
      right(linear) += rigid.mass * (state_.velocity[static_cast<std::size_t>(linear)] +
                                     dt_ * vector_of(system_.scene.gravity));
      right(linear + 1) += state_.angular_momentum[r];
    }
  }

  /// A += (dt^2 k + dt c) J^T J, b += J^T (-dt k d + (dt^2 k + dt c) u), J of p_a - p_b, d their
  /// difference now and u the velocity of an anchor; on rigid bodies also the stiffness of arms.
  void add_springs() {
    for (const BindingSpring& spring : system_.springs) {
      const auto pull = pull_of(system_, state_, drive_, spring);
      if (!pull) continue;
      for (const PointBlock& i : pull->jacobian) {
        right(i.block) += i.matrix.transpose() * pull->constant;
        for (const PointBlock& j : pull->jacobian) {
          block(i.block, j.block) += pull->weight * i.matrix.transpose() * j.matrix;
        }
      }
      add_arm(spring.a, pull->constant);
      if (spring.handle < 0) add_arm(spring.b, -pull->constant);
    }
  }

  /// dt^2 times the stiffness that an arm r has against rotations where a force f pulls at it:
  /// |r||f| cos^2(angle / 2) across the bisector of r and f, nothing about it.
  void add_arm(const MaterialPoint& point, const Vector3d& impulse) {
    if (point.rigid < 0) return;
    const Vector3d arm = state_.frame[static_cast<std::size_t>(point.rigid)].rotation * point.local;
    const double size = arm.norm() * impulse.norm();
    if (size == 0 || !(size < 1e150)) return;
    const Vector3d bisector = arm.normalized() + impulse.normalized();
    const double cosine = bisector.norm() / 2;  // of half the angle
    if (cosine * cosine <= 1e-9) return;
    const Vector3d d = bisector.normalized();
    const int angular = system_.linear_block(point.rigid) + 1;
    block(angular, angular) +=
        dt_ * size * cosine * cosine * (Matrix3d::Identity() - d * d.transpose());
  }

  const System& system_;
  const State& state_;
  const StepDrive& drive_;
  double dt_;
  LinearSystem result_;
};

}  // namespace

Matrix3d midpoint_rotation(const RigidBody& rigid,
                           const Matrix3d& rotation,
                           const Vector3d& angular_momentum,
                           double time_step) {
  Matrix3d middle = rotation;
  for (int pass = 0; pass < 2; ++pass) {
    const Vector3d omega = inertia_of(rigid, middle).llt().solve(angular_momentum);
    middle = turn_of(time_step / 2 * omega) * rotation;
  }
  return middle;
}

std::optional<SpringPull> pull_of(const System& system,
                                  const State& state,
                                  const StepDrive& drive,
                                  const BindingSpring& spring) {
  SpringPull pull;
  pull.jacobian = jacobian_of(system, state, spring.a);
  Vector3d end = position_of(system, state, spring.b);
  Vector3d anchor_velocity = Vector3d::Zero();
  if (spring.handle >= 0) {
    const auto h = static_cast<std::size_t>(spring.handle);
    const auto& after = drive.after.handles[h];
    if (!after) return std::nullopt;
    const Vector3d before = drive.before.handles[h].value_or(*after);
    end += before;
    anchor_velocity = (*after - before) / drive.time_step;
  } else {
    for (PointBlock block : jacobian_of(system, state, spring.b)) {
      block.matrix *= -1;
      pull.jacobian.push_back(block);
    }
  }
  const double dt = drive.time_step;
  pull.weight = dt * dt * spring.stiffness + dt * spring.damping;
  pull.constant = -dt * spring.stiffness * (position_of(system, state, spring.a) - end) +
                  pull.weight * anchor_velocity;
  return pull;
}

LinearSystem assemble(const System& system, const State& state, const StepDrive& drive) {
  return Assembly(system, state, drive).run();
}

}  // namespace tetwarp::reference

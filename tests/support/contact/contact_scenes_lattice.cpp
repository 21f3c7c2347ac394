#include <cmath>

#include "host/base/counter_hash.hpp"
#include "tests/support/contact/contact_scenes.hpp"
#include "tests/support/rigid_scene.hpp"

namespace tetwarp::scenes {

ContactProblem boxed_lattice(const BoxedLattice& choice) {
  constexpr double gravity = 9.81, radius = 0.05, mass = 1;
  const std::int64_t n = choice.edge;
  std::uint64_t counter = std::uint64_t{choice.seed} << 32;
  const auto dice = [&] { return 2 * unit_of(counter++) - 1; };
  RigidScene scene;
  for (std::int64_t body = 0; body < n * n * n; ++body) {
    const double pull = mass * gravity * choice.time_step;
    scene.add_body(mass, 0.4 * mass * radius * radius, {0.1 * pull, 0.05 * pull, -pull});
  }
  /// A contact of sphere a on the side `from` of it, with sphere b or, b = -1, the box.
  const auto touch = [&](std::int64_t a, std::int64_t b, Point3 from) {
    Point3 normal;
    double length = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      normal[axis] = choice.turn * dice() - from[axis];
      length += normal[axis] * normal[axis];
    }
    Point3 arm_a, arm_b = {};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      normal[axis] /= std::sqrt(length);
      arm_a[axis] = -radius * normal[axis];
      if (b >= 0) arm_b[axis] = radius * normal[axis];
    }
    scene.add_contact(a, arm_a, b, arm_b, normal, 0, choice.friction);
  };
  for (std::int64_t k = 0; k < n; ++k) {
    for (std::int64_t j = 0; j < n; ++j) {
      for (std::int64_t i = 0; i < n; ++i) {
        const std::int64_t sphere = i + n * (j + n * k);
        touch(sphere, k > 0 ? sphere - n * n : -1, {0, 0, -1});
        touch(sphere, j > 0 ? sphere - n : -1, {0, -1, 0});
        touch(sphere, i > 0 ? sphere - 1 : -1, {-1, 0, 0});
        if (j + 1 == n) touch(sphere, -1, {0, 1, 0});
        if (i + 1 == n) touch(sphere, -1, {1, 0, 0});
      }
    }
  }
  return scene.take();
}

void add_ball_joints(ContactProblem& problem, std::int64_t joints, double arm) {
  std::vector<Entry> entries;
  for (std::int64_t joint = 0; joint < joints; ++joint) {
    // v + omega x r with r = (arm, 0, 0) on the first body and (-arm, 0, 0) on the second.
    for (const std::int64_t side : {0, 1}) {
      const std::int64_t first = 6 * (2 * joint + side), row = 3 * joint;
      const double sign = side == 0 ? 1 : -1;
      for (std::int64_t axis = 0; axis < 3; ++axis) {
        entries.push_back({row + axis, first + axis, sign});
      }
      entries.push_back({row + 1, first + 5, arm});
      entries.push_back({row + 2, first + 4, -arm});
    }
    problem.bilateral.group_start.push_back(static_cast<std::int32_t>(3 * joint));
  }
  problem.bilateral.group_start.push_back(static_cast<std::int32_t>(3 * joints));
  problem.bilateral.jacobian = sparse_matrix(3 * joints, problem.dof_count(), std::move(entries));
}

}  // namespace tetwarp::scenes

#include "tests/support/contact/contact_scenes.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/base/counter_hash.hpp"
#include "host/base/point3.hpp"
#include "tests/support/rigid_scene.hpp"

namespace tetwarp::scenes {
namespace {
constexpr double gravity = 9.81;

/// Seeded numbers in [-1, 1), one after the other.
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : counter_(std::uint64_t{seed} << 32) {}
  double next() { return 2 * unit_of(counter_++) - 1; }

 private:
  std::uint64_t counter_;
};

Point3 direction(Dice& dice) {
  Point3 v;
  double length = 0;
  do {
    v = {dice.next(), dice.next(), dice.next()};
    length = std::hypot(v[0], v[1], v[2]);
  } while (length > 1 || length < 0.1);
  for (double& x : v) x /= length;
  return v;
}
}  // namespace

SparseMatrix sparse_matrix(std::int64_t rows, std::int64_t columns, std::vector<Entry> entries) {
  std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.row != b.row ? a.row < b.row : a.column < b.column;
  });
  SparseMatrix matrix{rows, columns, {}, {}, {}};
  matrix.row_start.assign(static_cast<std::size_t>(rows) + 1, 0);
  for (std::size_t e = 0; e < entries.size(); ++e) {
    const Entry& entry = entries[e];
    if (e > 0 && entries[e - 1].row == entry.row && entries[e - 1].column == entry.column) {
      matrix.value.back() += entry.value;
      continue;
    }
    ++matrix.row_start[static_cast<std::size_t>(entry.row) + 1];
    matrix.column.push_back(static_cast<std::int32_t>(entry.column));
    matrix.value.push_back(entry.value);
  }
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
    matrix.row_start[row + 1] += matrix.row_start[row];
  }
  return matrix;
}

void add_glue(
    ContactProblem& problem, const Glue& glue, double time_step, double area, std::uint32_t seed) {
  if (glue.stiffness == 0) return;
  Dice dice(seed);
  const std::size_t contacts = problem.friction.size();
  AdhesionState& adhesion = problem.adhesion;
  adhesion.time_step = time_step;
  adhesion.area.assign(contacts, area);
  adhesion.stiffness.assign(contacts, glue.stiffness);
  adhesion.intensity.assign(contacts, glue.intensity);
  for (std::size_t c = 0; c < contacts; ++c) {
    const double normal = problem.is_local() ? 0.0 : time_step * problem.velocity_offset[3 * c];
    const double first = 1e-4 * dice.next(), second = 1e-4 * dice.next();
    adhesion.gap.insert(adhesion.gap.end(), {normal, first, second});
  }
}

ContactProblem random_local(const RandomLocal& choice) {
  // W = G G^T with few entries per column: positive semidefinite, plus a diagonal.
  Dice dice(choice.seed);
  const std::int64_t rows = 3 * choice.contacts;
  std::vector<Entry> entries;
  for (std::int64_t row = 0; row < rows; ++row) entries.push_back({row, row, 0.3});
  for (std::int64_t k = 0; k < choice.contacts * choice.neighbors; ++k) {
    std::array<std::pair<std::int64_t, double>, 6> column;
    const std::int64_t a = k % choice.contacts;
    const double place =
        unit_of((std::uint64_t{choice.seed} << 40) + static_cast<std::uint64_t>(k));
    const auto b = static_cast<std::int64_t>(place * static_cast<double>(choice.contacts));
    for (std::int64_t i = 0; i < 6; ++i) {
      column[static_cast<std::size_t>(i)] = {3 * (i < 3 ? a : b) + i % 3, dice.next()};
    }
    for (const auto& [row, x] : column) {
      for (const auto& [other, y] : column) {
        entries.push_back({row, other, x * y * (1 + choice.asymmetry * dice.next())});
      }
    }
  }
  ContactProblem problem;
  problem.delassus = sparse_matrix(rows, rows, std::move(entries));
  for (std::int64_t row = 0; row < rows; ++row) {
    problem.free_velocity.push_back(row % 3 == 0 ? dice.next() - 0.5 : dice.next());
  }
  problem.friction.assign(static_cast<std::size_t>(choice.contacts), choice.friction);
  add_glue(problem, choice.glue, 0.01, 1e-4, choice.seed + 1);
  return problem;
}

ContactProblem box_stack(const BoxStack& choice) {
  constexpr double half = 0.1;
  RigidScene scene;
  for (std::int64_t b = 0; b < choice.boxes; ++b) {
    const double height =
        choice.boxes == 1 ? 0.0 : static_cast<double>(b) / static_cast<double>(choice.boxes - 1);
    const double mass = std::pow(choice.mass_ratio, height);
    const double pull = mass * gravity * choice.time_step;
    scene.add_body(mass, mass * half * half * 2 / 3,
                   {b + 1 == choice.boxes ? 0.3 * pull : 0.0, 0.0, -pull});
  }
  for (std::int64_t b = 0; b < choice.boxes; ++b) {
    for (const double x : {-half, half}) {
      for (const double y : {-half, half}) {
        scene.add_contact(b, {x, y, -half}, b - 1, {x, y, half}, {0, 0, 1}, 0, choice.friction);
      }
    }
  }
  ContactProblem problem = scene.take();
  add_glue(problem, choice.glue, choice.time_step, half * half, 1);
  return problem;
}

ContactProblem sphere_packing(const SpherePacking& choice) {
  constexpr double radius = 0.05;
  Dice dice(choice.seed);
  RigidScene scene;
  std::vector<Point3> centers;
  const std::int64_t n = choice.edge;
  for (std::int64_t k = 0; k < n; ++k) {
    for (std::int64_t j = 0; j < n; ++j) {
      for (std::int64_t i = 0; i < n; ++i) {
        // Body-centered layers: every sphere rests on four below.
        const double shift = k % 2 == 0 ? 0.0 : 1.0;
        centers.push_back({radius * (2.05 * static_cast<double>(i) + shift + 0.05 * dice.next()),
                           radius * (2.05 * static_cast<double>(j) + shift + 0.05 * dice.next()),
                           radius * (1 + 1.4 * static_cast<double>(k) + 0.05 * dice.next())});
        const double mass = 1 + 0.5 * dice.next();
        scene.add_body(
            mass, 0.4 * mass * radius * radius,
            {0.02 * dice.next(), 0.02 * dice.next(), -mass * gravity * choice.time_step});
      }
    }
  }
  const auto count = static_cast<std::int64_t>(centers.size());
  for (std::int64_t a = 0; a < count; ++a) {
    const Point3& x = centers[static_cast<std::size_t>(a)];
    const auto is_kept = [&] { return (dice.next() + 1) / 2 < choice.kept; };
    if (a < n * n && is_kept()) {
      scene.add_contact(a, {0, 0, -radius}, -1, {}, {0, 0, 1},
                        choice.gaps * (x[2] - radius) / choice.time_step, choice.friction);
    }
    // Neighbors are among the spheres of this layer and the one below.
    for (std::int64_t b = std::max<std::int64_t>(a - 2 * n * n, 0); b < a; ++b) {
      const Point3& y = centers[static_cast<std::size_t>(b)];
      Point3 normal = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
      const double distance =
          std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
      if (distance > 2.15 * radius || !is_kept()) continue;
      for (double& component : normal) component /= distance;
      Point3 arm = normal;
      for (double& component : arm) component *= radius;
      scene.add_contact(a, {-arm[0], -arm[1], -arm[2]}, b, arm, normal,
                        choice.gaps * std::max(distance - 2 * radius, -1e-3) / choice.time_step,
                        choice.friction);
    }
  }
  ContactProblem problem = scene.take();
  add_glue(problem, choice.glue, choice.time_step, 1e-4, choice.seed + 1);
  return problem;
}

ContactProblem jam(const Jam& choice) {
  constexpr double time_step = 0.01;
  Dice dice(choice.seed);
  RigidScene scene;
  for (std::int64_t b = 0; b < choice.bodies; ++b) {
    const double mass = std::pow(choice.mass_ratio, (1 + dice.next()) / 2);
    const double pull = mass * gravity * time_step;
    scene.add_body(mass, 0.4 * mass,
                   {pull * dice.next(), pull * dice.next(), pull * (dice.next() - 1)});
  }
  for (std::int64_t c = 0; c < choice.contacts; ++c) {
    const std::int64_t a = c % choice.bodies;
    const auto step = static_cast<std::int64_t>((1 + dice.next()) / 2 * 1.4 *
                                                static_cast<double>(choice.bodies - 1));
    const bool is_free = step + 1 < choice.bodies;  // else it touches the world
    const Point3 arm_a = direction(dice), arm_b = direction(dice);
    scene.add_contact(a, arm_a, is_free ? (a + 1 + step) % choice.bodies : -1, arm_b,
                      direction(dice), 0, choice.friction);
  }
  ContactProblem problem = scene.take();
  add_glue(problem, choice.glue, time_step, 1e-4, choice.seed + 1);
  return problem;
}

ContactProblem beside(ContactProblem a, const ContactProblem& b) {
  const auto dofs = static_cast<std::int32_t>(a.dof_count());
  const std::int64_t entries = a.system.row_start.back();
  for (std::size_t row = 1; row < b.system.row_start.size(); ++row) {
    a.system.row_start.push_back(entries + b.system.row_start[row]);
  }
  for (const std::int32_t column : b.system.column) a.system.column.push_back(dofs + column);
  a.system.value.insert(a.system.value.end(), b.system.value.begin(), b.system.value.end());
  a.load.insert(a.load.end(), b.load.begin(), b.load.end());
  for (std::size_t k = 1; !a.block_start.empty() && k < b.block_start.size(); ++k) {
    a.block_start.push_back(dofs + b.block_start[k]);
  }
  a.system.rows = a.system.columns = a.jacobian.columns = dofs + b.dof_count();
  return a;
}

ContactProblem squeezed_sphere() {
  RigidScene scene;
  scene.add_body(1, 0.004, {0, 0, -0.1});
  scene.add_contact(0, {0, 0, -0.1}, -1, {}, {0, 0, 1}, -1, 0.5);
  scene.add_contact(0, {0, 0, 0.1}, -1, {}, {0, 0, -1}, -1, 0.5);
  return scene.take();
}

}  // namespace tetwarp::scenes

/// @file contact_block.cpp
/// A block falls onto an adhesive floor, is lifted, pulled sideways and lifted again: it sticks,
/// slides and separates. Prints each event; succeeds if all occurred.
///
/// Each step: find contacts, match them by the tracker with those of the previous step, build A v =
/// J^T r + b, solve, move, and pass the solution to the tracker, which updates the adhesion.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <tetwarp/contact.hpp>
#include <tetwarp/contact_tracker.hpp>
#include <vector>

namespace {
using tetwarp::Point3;

constexpr double mass = 1;          // kg
constexpr double weight = 9.81;     // N
constexpr double edge = 0.1;        // m
constexpr double time_step = 2e-3;  // s
constexpr double friction = 0.3;    // without adhesion the block holds 2.9 N sideways

/// Bonds grow where the block presses: towards p / p0 = 981 Pa / 500 Pa, so to 1, at 5/s. A full
/// bond of 0.01 m^2 carries area sqrt(W C) = 5 N, stretched by sqrt(W / C) = 0.05 mm.
const tetwarp::ContactMaterial sticky_floor = {.friction = friction,
                                               .stiffness = 1e7,
                                               .energy = 0.025,
                                               .viscosity = 0.0025,
                                               .bonding_rate = 0.01,
                                               .saturation_pressure = 500};

/// Numbers of the bodies in keys and poses.
enum Body { floor_body, block_body };

/// The block moves without turning, so three degrees of freedom describe it.
struct Block {
  Point3 center = {0, 0, edge / 2 + 0.02};  // m
  Point3 velocity = {0, 0, 0};              // m/s
};

/// Collision detection: the lower face, as one contact, against the plane z = 0. (Bodies that turn
/// take one per corner, each with its share of the area.)
std::vector<tetwarp::ReportedContact> contacts_of(const Block& block) {
  const double x = block.center[0], y = block.center[1], gap = block.center[2] - edge / 2;
  if (gap > 1e-3) return {};
  return {{.key = {floor_body, 0, block_body, 0},
           .point_a_world = {x, y, 0},
           .point_b_world = {x, y, gap},
           .normal = {0, 0, -1},  // from the block to the floor
           .area = edge * edge}};
}

/// A = mass, b = momentum with the step's forces, and a row of J per contact and axis. The relative
/// velocity is that of body a minus that of body b: the floor rests, so minus the block's. (A body
/// that turns has three more columns: -(point - center) x axis.)
tetwarp::ContactProblem problem_of(const Block& block,
                                   const Point3& force,
                                   const std::vector<tetwarp::TrackedContact>& contacts) {
  tetwarp::ContactProblem problem;
  problem.system = {3, 3, {0, 1, 2, 3}, {0, 1, 2}, {mass, mass, mass}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    problem.load.push_back(mass * block.velocity[axis] + time_step * force[axis]);
  }
  problem.load[2] -= time_step * weight;
  problem.block_start = {0, 3};
  problem.jacobian.columns = 3;
  problem.jacobian.row_start = {0};
  for (const tetwarp::TrackedContact& contact : contacts) {
    for (const Point3& axis : contact.axes) {
      for (std::int32_t column : {0, 1, 2}) problem.jacobian.column.push_back(column);
      for (const double x : axis) problem.jacobian.value.push_back(-x);
      problem.jacobian.row_start.push_back(std::ssize(problem.jacobian.column));
      ++problem.jacobian.rows;
    }
  }
  return problem;
}

/// Until when which force acts at the block's center.
const struct {
  double until;  // s
  Point3 force;  // N
  const char* what;
} phases[] = {
    {0.6, {0, 0, 0}, "falls and rests"}, {0.8, {0, 0, weight + 3}, "lifted: the bond holds"},
    {1.2, {6, 0, 0}, "pulled sideways"}, {1.3, {12, 0, 0}, "pulled harder: slides"},
    {1.6, {0, 0, 0}, "slows down"},      {1.8, {0, 0, weight + 3}, "lifted again: lets go"},
};
}  // namespace

int main() {
  Block block;
  const auto poses = [&] { return std::vector<tetwarp::BodyPose>{{}, {.position = block.center}}; };
  tetwarp::ContactTracker tracker({.materials = {sticky_floor}});
  tetwarp::ContactSolver solver({.tolerance = 1e-8});
  bool held = false, stuck = false, slid = false, let_go = false;
  std::puts("  time    moved   height    beta  pressing  shearing");
  std::puts("     s       mm       mm               N         N");
  int step = 0;
  for (const auto& phase : phases) {
    for (; step * time_step < phase.until; ++step) {
      const auto& contacts = tracker.begin_step(contacts_of(block), poses(), time_step);
      tetwarp::ContactProblem problem = problem_of(block, phase.force, contacts);
      tracker.fill(problem);  // friction, adhesion, gaps, and impulses to start from
      const tetwarp::ContactSolution solution = solver.solve(problem);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block.velocity[axis] = solution.body_velocity[axis];
        block.center[axis] += time_step * block.velocity[axis];
      }
      tracker.end_step(solution, poses());

      double pressing = 0, shearing = 0, intensity = 0;  // pressing < 0: the bonds pull
      if (!solution.impulse.empty()) {
        pressing = solution.impulse[0] / time_step;
        shearing = std::hypot(solution.impulse[1], solution.impulse[2]) / time_step;
      }
      if (!tracker.records().empty()) intensity = tracker.records().front().intensity;
      const double height = block.center[2] - edge / 2;
      const double speed = std::hypot(block.velocity[0], block.velocity[1]);
      held = held || pressing < -2.9;
      // More than friction alone could hold, and hardly moving: the bonds carry the rest.
      stuck = stuck || (shearing > 1.5 * friction * weight && speed < 1e-6);
      slid = slid || (stuck && speed > 0.1);
      let_go = let_go || (slid && intensity == 0 && height > 1e-3);
      if (step % 50 == 0) {
        std::printf("%6.3f %8.3f %8.3f %7.3f %9.2f %9.2f  %s\n", step * time_step,
                    1e3 * block.center[0], 1e3 * height, intensity, pressing, shearing, phase.what);
      }
    }
  }
  std::printf("held %d, stuck %d, slid %d, let go %d\n", held, stuck, slid, let_go);
  return held && stuck && slid && let_go ? 0 : 1;
}

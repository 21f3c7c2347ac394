/// @file example_contact.cpp
/// A block falls onto a sticky floor, is pulled sideways and lifted: it touches, sticks, slides and
/// lets go. Prints what happens; succeeds if all of it did.
///
/// How a simulation uses the library is in rigid_bodies.cpp, RigidWorld::step() and assemble().
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "tests/scenes/rigid_bodies.hpp"

namespace {

using namespace tetwarp;
using namespace tetwarp::test;

constexpr double weight = 9.81;   // N, of a block of 1 kg
constexpr double edge = 0.1;      // m
constexpr double friction = 0.3;  // dry, the block holds 2.9 N sideways

/// Bonds grow where the block presses: towards p / p0 = 981 Pa / 500 Pa, so to 1, at 5/s. A full
/// bond of 0.01 m^2 carries area sqrt(W C) = 5 N, stretched by sqrt(W / C) = 0.05 mm.
const ContactMaterial sticky_floor = {.friction = friction,
                                      .stiffness = 1e7,
                                      .energy = 0.025,
                                      .viscosity = 0.0025,
                                      .bonding_rate = 0.01,
                                      .saturation_pressure = 500};

/// Where the block is pulled, as time goes by.
struct Act {
  double until;           // s
  Eigen::Vector3d force;  // N, at the block's center
  const char* what;
};
const Act acts[] = {
    {0.6, {0, 0, 0}, "falls and rests"}, {1.0, {6, 0, 0}, "pulled sideways"},
    {1.1, {12, 0, 0}, "pulled harder"},  {1.9, {0, 0, 0}, "slows down, rests"},
    {2.2, {0, 0, weight + 3}, "lifted"}, {2.3, {0, 0, weight + 9}, "lifted harder"},
};

/// What the floor does to the block in one step.
struct State {
  double height = 0;     // of its lower face, m
  double speed = 0;      // sideways, m/s
  double pressing = 0;   // N, negative: the bonds hold it back
  double shearing = 0;   // N
  double intensity = 0;  // beta, the mean of all contacts
};

State observed(const RigidWorld& world, double time_step) {
  const RigidBox& block = world.boxes.front();
  State state;
  state.height = block.pose.position[2] - edge / 2;
  state.speed = std::hypot(block.velocity.x(), block.velocity.y());
  const auto& impulse = world.solution().impulse;
  double sideways[2] = {0, 0};
  for (std::size_t row = 0; row < impulse.size(); row += 3) {
    state.pressing += impulse[row] / time_step;
    sideways[0] += impulse[row + 1] / time_step;
    sideways[1] += impulse[row + 2] / time_step;
  }
  state.shearing = std::hypot(sideways[0], sideways[1]);
  for (const ContactRecord& record : world.tracker.records())
    state.intensity += record.intensity / 4;
  return state;
}

}  // namespace

int main() {
  WorldOptions options;
  options.time_step = 2e-3;
  options.tracking.materials = {sticky_floor};
  options.solving.tolerance = 1e-8;
  RigidWorld world(options);
  world.planes.push_back({{0, 0, 0}, {0, 0, 1}});
  world.boxes.push_back(make_box(Eigen::Vector3d::Constant(edge / 2), 1.0));
  world.boxes.front().pose.position = {0, 0, edge / 2 + 0.02};

  bool touched = false, stuck = false, slid = false, held = false, let_go = false;
  std::printf("  time    moved   height    beta  pressing  shearing\n");
  std::printf("     s       mm       mm               N         N\n");
  double next_row = 0;
  const auto print_row = [&](const State& state, const char* what) {
    std::printf("%6.3f %8.3f %8.3f %7.3f %9.2f %9.2f  %s\n", world.time(),
                1e3 * world.boxes.front().pose.position[0], 1e3 * state.height, state.intensity,
                state.pressing, state.shearing, what);
  };
  const auto note = [&](bool& seen, bool is_so, const State& state, const char* what) {
    if (seen || !is_so) return;
    seen = true;
    print_row(state, what);
  };

  for (const Act& act : acts) {
    world.boxes.front().force = act.force;
    while (world.time() < act.until - options.time_step / 2) {
      world.step();
      const State state = observed(world, options.time_step);
      if (world.time() >= next_row) {
        print_row(state, act.what);
        next_row += 0.1;
      }
      note(touched, state.pressing > 0, state, "** touches");
      // More than friction alone could hold, and hardly moving: bonds carry the rest.
      note(stuck, state.shearing > 1.5 * friction * weight && state.speed < 1e-6, state,
           "** sticks");
      note(slid, stuck && state.speed > 0.1, state, "** slides");
      note(held, slid && state.pressing < -2.9, state, "** is held back");
      note(let_go, held && state.intensity == 0 && state.height > 1e-3, state, "** lets go");
    }
  }
  if (touched && stuck && slid && let_go) return 0;
  std::fprintf(stderr, "contact example: the block should touch, stick, slide and let go\n");
  return 1;
}

/// @file test_live_simulation.cpp
/// Live simulations without a window: orders, tools, records and their repetition.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <tetwarp/error.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/input_log.hpp"
#include "host/view/live_simulation.hpp"
#include "host/view/live_start.hpp"
#include "host/view/view_options.hpp"
#include "host/view/view_tools.hpp"
#include "tests/support/run_command.hpp"
#include "tests/view/live_scene.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

TEST(LiveSimulation, StepsOnOrderAndPullsWhatIsGrabbed) {
  ViewOptions options;
  options.paused = true;
  LiveSimulation simulation(live_scene(), options, {});
  EXPECT_EQ(simulation.thread_seconds(), 0);
  simulation.begin();
  const LiveFrame first = frame_at(simulation, 0);
  EXPECT_TRUE(first.is_paused);
  ASSERT_EQ(first.volumes.size(), 1u);
  EXPECT_EQ(first.points.size(), 2u);
  Point3 top = first.points[0][0];
  for (const Point3& x : first.points[0]) top = x[2] > top[2] ? x : top;
  simulation.give({.kind = OrderKind::grab, .body = 0, .point = top});
  simulation.give({.kind = OrderKind::pull, .point = {top[0], top[1], top[2] + 0.1}});
  simulation.give({.kind = OrderKind::step});
  simulation.give({.kind = OrderKind::step});
  const LiveFrame pulled = frame_at(simulation, 2);
  EXPECT_EQ(pulled.step, 2);
  ASSERT_TRUE(pulled.grab);
  EXPECT_GT(pulled.grab->force[2], 0);
  EXPECT_EQ(pulled.message, "");
  simulation.give({.kind = OrderKind::release});
  simulation.give({.kind = OrderKind::restart});
  simulation.give({.kind = OrderKind::step});
  const LiveFrame again = frame_at(simulation, 3);
  EXPECT_EQ(again.step, 1);
  EXPECT_FALSE(again.grab);
  const double spent = simulation.thread_seconds();
  EXPECT_GT(spent, 0);
  simulation.end();
  EXPECT_GE(simulation.thread_seconds(), spent);
  EXPECT_EQ(simulation.log().events.size(), 4u);
}

/// The mouse takes a scripted ball into a block: the ball follows at a limited speed, pushes, and
/// stays where it was let go; a replay has the same bits.
TEST(LiveSimulation, CarriesAScriptedBodyThatPushes) {
  Scene scene = live_scene();
  scene.bodies[1].kind = BodyKind::scripted;
  scene.bodies[1].rigid = {};
  scene.gravity = {0, 0, 0};
  ViewOptions options;
  options.paused = true;
  LiveSimulation simulation(scene, options, {});
  simulation.begin();
  const double top = bounds_of(frame_at(simulation, 0).points[0]).high[2];
  simulation.give({.kind = OrderKind::grab, .body = 1, .point = {0, 0, 0.2}});
  simulation.give({.kind = OrderKind::pull, .point = {0, 0, 0.16}});
  std::int64_t tick = 0;
  double below = 0.2;
  for (; tick < 10; ++tick) {
    simulation.give({.kind = OrderKind::step});
    const LiveFrame& frame = frame_at(simulation, tick + 1);
    ASSERT_TRUE(frame.grab);
    // Five sizes, the diagonals of the box of the ball, a second.
    EXPECT_LE(below - frame.grab->point[2], 5 * 0.06 * std::sqrt(3) * 0.01 + 1e-12);
    below = frame.grab->point[2];
  }
  EXPECT_NEAR(below, 0.16, 1e-12);
  const LiveFrame pushed = simulation.frames().front();
  EXPECT_GT(pushed.grab->force[2], 0);
  double under = 0;  // the top of the block, below the ball
  for (const Point3& x : pushed.points[0]) {
    if (std::hypot(x[0], x[1]) < 0.01) under = std::max(under, x[2]);
  }
  EXPECT_LT(under, top - 0.015);
  simulation.give({.kind = OrderKind::release});
  simulation.give({.kind = OrderKind::step});
  EXPECT_FALSE(frame_at(simulation, tick + 1).grab);
  EXPECT_NEAR(bounds_of(simulation.frames().front().points[1]).low[2], 0.1, 1e-3);
  simulation.end();

  options.paused = false;
  LiveSimulation repeated(scene, options, simulation.log());
  repeated.begin();
  while (!frame_at(repeated, 0).is_last) {
  }
  repeated.end();
  EXPECT_EQ(repeated.checkpoint(), simulation.checkpoint());
}

/// The outer finger is carried to the block's side; the inner one follows, presses on the block,
/// and the force is that of the spring and its critical damping. A replay has the same bits.
TEST(LiveSimulation, FingersPressThroughTheSkin) {
  ViewOptions options;
  options.paused = true;
  options.fingers = {{0.2, 0, 0, 0.12, 0, 0, 0.02}};
  options.skin_stiffness = 100;
  Scene scene = live_scene();
  scene.gravity = {0, 0, 0};
  add_tools(options, scene);
  LiveSimulation simulation(scene, options, {});
  const double mass = simulation.simulator().body(3).mass;
  simulation.begin();
  const LiveFrame first = frame_at(simulation, 0);
  const double damping = 2 * std::sqrt(100 * mass);
  const double side = bounds_of(first.points[0]).high[0];
  simulation.give({.kind = OrderKind::grab, .body = 2, .point = {0.2, 0, 0}});
  simulation.give({.kind = OrderKind::pull, .point = {0.13, 0, 0}});
  double before = 0;
  for (int n = 1; n <= 60; ++n) {
    before = simulation.frames().front().grab->point[0];
    simulation.give({.kind = OrderKind::step});
    frame_at(simulation, n);
  }
  const LiveFrame pressed = simulation.frames().front();
  ASSERT_TRUE(pressed.grab);
  const double center = pressed.grab->point[0];
  EXPECT_GT(center, side + 0.01) << "it would be at 0.05 without the block";
  EXPECT_NEAR(pressed.grab->target[0], 0.05, 1e-9);
  EXPECT_NEAR(bounds_of(pressed.points[2]).high[0], 0.15, 1e-3) << "the outer finger";
  const double speed = (center - before) / scene.time_step;
  EXPECT_NEAR(pressed.grab->force[0], 100 * (0.05 - center) - damping * speed, 1e-6);
  simulation.give({.kind = OrderKind::release});
  simulation.give({.kind = OrderKind::restart});
  simulation.give({.kind = OrderKind::step});
  EXPECT_NEAR(frame_at(simulation, 61).grab->target[0], 0.12, 1e-12);
  simulation.end();

  options.paused = false;
  LiveSimulation repeated(scene, options, simulation.log());
  repeated.begin();
  while (!frame_at(repeated, 0).is_last) {
  }
  repeated.end();
  EXPECT_EQ(repeated.checkpoint(), simulation.checkpoint());
}

/// A simulation that goes on from a checkpoint has its bits; the ball is where it was carried to,
/// and is carried on from there.
TEST(LiveSimulation, GoesOnFromACheckpoint) {
  const TemporaryFolder folder;
  Scene scene = live_scene();
  scene.bodies[1].kind = BodyKind::scripted;
  const auto run_steps = [](LiveSimulation& simulation, int steps) {
    simulation.begin();
    frame_at(simulation, 0);
    simulation.give({.kind = OrderKind::grab, .body = 1, .point = {0, 0, 0.2}});
    simulation.give({.kind = OrderKind::pull, .point = {0.05, 0, 0.2}});
    for (int n = 1; n <= steps; ++n) {
      simulation.give({.kind = OrderKind::step});
      frame_at(simulation, n);
    }
    simulation.end();
  };
  ViewOptions options;
  options.paused = true;
  LiveSimulation first(scene, options, {});
  run_steps(first, 12);
  const std::vector<std::byte> bytes = first.checkpoint();
  std::ofstream(folder / "state.bin")
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  options.restart = folder / "state.bin";
  LiveSimulation second(scene, options, {});
  EXPECT_EQ(second.checkpoint(), bytes);
  EXPECT_NEAR(bounds_of(second.simulator().surface_positions(1)).high[0], 0.03 + 0.05, 1e-3);
  run_steps(second, 12);
  EXPECT_NEAR(bounds_of(second.simulator().surface_positions(1)).high[0], 0.03 + 0.1, 1e-3);
  EXPECT_EQ(second.simulator().step_index(), 24);
  std::ofstream(folder / "state.bin") << "no state";
  EXPECT_THROW(LiveSimulation(scene, options, {}), IoError);
}

/// Steps that the clock ends are ended at the same place when they are repeated.
TEST(LiveSimulation, RepeatsStepsThatWereOutOfTime) {
  ViewOptions options;
  options.fast = true;
  options.steps = 40;
  options.max_step_seconds = 1e-9;
  options.record = "kept by the caller";
  Scene scene = live_scene();
  scene.bodies[1].velocity = {0, 0, -3};
  LiveSimulation recorded(scene, options, {});
  recorded.begin();
  while (!frame_at(recorded, 0).is_last) {
  }
  const std::int64_t late = recorded.frames().front().late_steps;
  recorded.end();
  const std::int64_t limits =
      std::ranges::count(recorded.log().events, InputKind::limit, &InputEvent::kind);
  EXPECT_GE(limits, late);
  ASSERT_GT(late, 0);

  const TemporaryFolder folder;
  std::ofstream(folder / "input.txt") << text_of(recorded.log());
  LiveSimulation repeated(scene, {}, read_input_log(folder / "input.txt"));
  repeated.begin();
  while (!frame_at(repeated, 0).is_last) {
  }
  repeated.end();
  EXPECT_EQ(repeated.log().events, recorded.log().events);
  EXPECT_EQ(repeated.checkpoint(), recorded.checkpoint());
  options.threads = 2;
  EXPECT_THROW(LiveSimulation(scene, options, {}), std::invalid_argument);
}

/// A record of another scene of the same name, or one that was changed.
TEST(LiveSimulation, AReplayEndsAtInputThatCannotBe) {
  const PointHandle right{.body = "ball", .center = {0, 0, 0.2}, .radius = 0.1, .stiffness = 5};
  PointHandle stranger = right, nowhere = right;
  stranger.body = "nobody";
  nowhere.radius = -1;
  for (const InputEvent& bad :
       {InputEvent{.tick = 2, .kind = InputKind::grab, .handle = stranger},
        InputEvent{.tick = 2, .kind = InputKind::grab, .handle = nowhere},
        InputEvent{.tick = 2, .kind = InputKind::carry, .handle = right},
        InputEvent{.tick = 2, .kind = InputKind::move}, InputEvent{.tick = 2}}) {
    ViewOptions options;
    options.replay = "input.txt";
    InputLog log = LiveSimulation(live_scene(), options, {}).log();
    log.events = {bad, {.tick = 2, .kind = InputKind::restart}};
    log.ticks = 5;
    LiveSimulation simulation(live_scene(), options, log);
    simulation.begin();
    while (!frame_at(simulation, 0).has_failed) {
    }
    simulation.end();
    EXPECT_EQ(simulation.log().ticks, 2);
    EXPECT_TRUE(simulation.frames().front().message.starts_with(
        "input.txt: its input before step 3 cannot be repeated: "))
        << simulation.frames().front().message;
  }
}

/// Whatever the names: a change of the scene, its tools or its start is another simulation.
TEST(LiveSimulation, AReplayIsOfTheSameSceneAndStart) {
  ViewOptions options, repeat;
  options.scene_file = "recorded.json";
  const InputLog log = LiveSimulation(live_scene(), options, {}).log();
  repeat.scene_file = "elsewhere/renamed.json";
  repeat.replay = "input.txt";
  EXPECT_NO_THROW(LiveSimulation(live_scene(), repeat, log));
  std::vector<Scene> others(4, live_scene());
  others[0].bodies[1].pose.position[2] += 1e-9;
  others[1].time_step *= 2;
  others[2].bodies[0].material.youngs_modulus += 1;
  repeat.scene_file = "recorded.json";
  repeat.ball = {{1, 2, 3, 0.1}};
  others[3].bodies.pop_back();
  add_tools(repeat, others[3]);
  for (const Scene& other : others) {
    try {
      const LiveSimulation simulation(other, repeat, log);
      ADD_FAILURE();
    } catch (const IoError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("input.txt: was recorded with another"))
          << error.what();
    }
  }
}

/// Nobody holds what was pulled when the checkpoint was written.
TEST(LiveSimulation, APullEndsWithItsCheckpoint) {
  const TemporaryFolder folder;
  ViewOptions options;
  options.paused = true;
  LiveSimulation pulled(live_scene(), options, {});
  pulled.begin();
  frame_at(pulled, 0);
  pulled.give({.kind = OrderKind::grab, .body = 1, .point = {0, 0, 0.2}});
  pulled.give({.kind = OrderKind::pull, .point = {0.05, 0, 0.2}});
  pulled.give({.kind = OrderKind::step});
  EXPECT_GT(frame_at(pulled, 1).grab->force[0], 0);
  pulled.end();
  const std::vector<std::byte> bytes = pulled.checkpoint();
  options.restart = folder / "pulled.bin";
  std::ofstream(options.restart, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
  Simulator restarted(live_scene(), simulate_options(options, {}));
  const std::vector<std::byte> start = first_state(options, restarted);
  for (int n = 0; n < 2; ++n) {  // the second time after the key r
    restarted.step();
    EXPECT_EQ(restarted.record().bodies[1].handle_force, (Point3{0, 0, 0}));
    restarted.restore(start);
  }
}

TEST(LiveSimulation, RepeatsItsInputBitForBit) {
  ViewOptions options;
  options.paused = true;
  LiveSimulation recorded(live_scene(), options, {});
  recorded.begin();
  const LiveFrame first = frame_at(recorded, 0);
  recorded.give({.kind = OrderKind::step});
  frame_at(recorded, 1);
  recorded.give({.kind = OrderKind::grab, .body = 1, .point = {0, 0, 0.2}});
  for (int n = 1; n <= 8; ++n) {
    recorded.give({.kind = OrderKind::pull, .point = {0.01 * n, 0, 0.2}});
    recorded.give({.kind = OrderKind::step});
    frame_at(recorded, 1 + n);
  }
  recorded.give({.kind = OrderKind::release});
  recorded.give({.kind = OrderKind::step});
  recorded.end();  // after the step
  EXPECT_EQ(recorded.log().ticks, 10);

  options.paused = false;
  LiveSimulation repeated(live_scene(), options, recorded.log());
  repeated.begin();
  while (!frame_at(repeated, 0).is_last) {
  }
  repeated.end();
  EXPECT_EQ(repeated.log().events, recorded.log().events);
  EXPECT_EQ(repeated.checkpoint(), recorded.checkpoint());
}

}  // namespace
}  // namespace tetwarp::test

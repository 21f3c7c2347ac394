/// @file test_device_hand.cpp
/// What devices do: sticks and tracked wands, in a room and to a simulation.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/devices/simulated_device.hpp"
#include "host/view/hand/device_hand.hpp"
#include "host/view/hand/scene_hand.hpp"
#include "tests/support/run_command.hpp"
#include "tests/view/live_scene.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

/// A device whose state the test sets.
class ToldDevice : public InputDevice {
 public:
  ToldDevice(const DeviceState& says, const std::string& suffers, const bool& is_gone)
      : says_(says), suffers_(suffers), is_gone_(is_gone) {}
  std::optional<DeviceSpan> read() override {
    if (is_gone_) return std::nullopt;
    return DeviceSpan{says_, 0.1};
  }
  std::string problem() const override { return suffers_; }

 private:
  const DeviceState& says_;
  const std::string& suffers_;
  const bool& is_gone_;
};

/// A hand with two devices, the second one at rest unless set, and what they did. A
/// body is everywhere, 2 m along each ray.
struct TestHand {
  TestHand() {
    std::vector<std::unique_ptr<InputDevice>> devices;
    devices.push_back(std::make_unique<ToldDevice>(says, suffers, is_gone));
    devices.push_back(std::make_unique<ToldDevice>(other_says, other_suffers, is_other_gone));
    HandActions actions;
    actions.meet = [this](const EyeRay& ray) -> std::optional<Pick> {
      met.push_back(ray);
      if (is_empty) return std::nullopt;
      return Pick{3, plus(ray.origin, times(2, unit(ray.direction))), 2};
    };
    actions.grab = [this](const Pick& point) { grabbed.push_back(point); };
    actions.pull = [this](const Point3& target) { pulled.push_back(target); };
    actions.release = [this] { ++releases; };
    actions.probe = [this](const EyeRay& ray) { probed.push_back(ray); };
    actions.place = [this](const Camera& of) {
      RoomPlace placed = room;
      placed.origin = plus(room.origin, minus(of.eye, first_eye));
      return placed;
    };
    hand = std::make_unique<DeviceHand>(std::move(devices), std::move(actions));
  }
  bool update() { return hand->update(camera, {camera.eye, {0, 1, 0}}); }

  Camera camera{.eye = {0, -2, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}};
  // x, y and z of the room are x, z and -y of the world, where a meter of the room is 0.5 m.
  // Its observer goes with the camera.
  RoomPlace room{{0, 1, 0}, {0, -2, 0}, {{{0.5, 0, 0}, {0, 0, 0.5}, {0, -0.5, 0}}}};
  const Point3 first_eye = camera.eye;
  DeviceState says, other_says;
  std::string suffers, other_suffers;
  bool is_empty = false, is_gone = false, is_other_gone = false;
  std::vector<EyeRay> met, probed;
  std::vector<Pick> grabbed;
  std::vector<Point3> pulled;
  int releases = 0;
  std::unique_ptr<DeviceHand> hand;
};

void expect_close(const Point3& found, const Point3& expected, double bound) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], bound);
}

std::array<double, 4> turn_about(const Point3& axis, double angle) {
  const Point3 part = times(std::sin(angle / 2), unit(axis));
  return {std::cos(angle / 2), part[0], part[1], part[2]};
}

/// By hand: a wand 1 m to the right of the observer points ahead, then a quarter turn to the left.
TEST(DeviceHand, AWandTakesWhatItPointsAtAndTurnsItAboutItself) {
  TestHand test;
  test.says.pose = DevicePose{{1, 1, 0}, {1, 0, 0, 0}};
  EXPECT_FALSE(test.update());
  ASSERT_EQ(test.hand->rays().size(), 1u);
  expect_close(test.hand->rays()[0][0], {0.5, -2, 0}, 1e-12);
  expect_close(test.hand->rays()[0][1], {0.5, 0, 0}, 1e-12);
  EXPECT_TRUE(test.hand->has_news());
  test.update();
  EXPECT_FALSE(test.hand->has_news()) << "nothing has moved";
  test.says.grabs = true;
  test.update();
  ASSERT_EQ(test.grabbed.size(), 1u);
  EXPECT_EQ(test.grabbed[0].body, 3u);
  EXPECT_TRUE(test.pulled.empty());
  test.says.pose->rotation = turn_about({0, 1, 0}, std::numbers::pi / 2);
  test.update();
  ASSERT_EQ(test.pulled.size(), 1u);
  expect_close(test.pulled[0], {-1.5, -2, 0}, 1e-12);
  expect_close(test.hand->rays()[0][1], test.pulled[0], 0);
  test.says.grabs = false;
  test.update();
  EXPECT_EQ(test.releases, 1);
  EXPECT_EQ(test.grabbed.size(), 1u);
}

/// Whatever the wand does, what it holds keeps its distance from it and stays on its ray.
TEST(DeviceHand, WhatAWandHoldsMovesRigidlyWithIt) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  TestHand test;
  test.says.pose = DevicePose{};
  test.says.grabs = true;
  test.update();
  ASSERT_EQ(test.grabbed.size(), 1u);
  for (int trial = 0; trial < 100; ++trial) {
    DevicePose& pose = *test.says.pose;
    pose.position = {any(random), any(random), any(random)};
    const Point3 axis{any(random), any(random), any(random)};
    pose.rotation = turn_about(axis, 4 * any(random));
    test.says.move = {any(random), 0, any(random)};  // the room moves through the scene as well
    test.room.origin = {any(random), any(random), any(random)};
    test.update();
    const auto [from, to] = test.hand->rays()[0];
    EXPECT_EQ(to, test.pulled.back());
    const Point3 moved = minus(test.camera.eye, test.first_eye);  // in the same update
    expect_close(from, plus(test.room.world_of(pose.position), moved), 1e-12);
    EXPECT_NEAR(norm(minus(to, from)), 2, 1e-12);
  }
  const std::size_t rays = test.met.size();
  test.says.grabs = false;
  test.says.move = {};
  test.update();
  EXPECT_EQ(test.releases, 1);
  // The ray of a free wand is that along which it held.
  expect_close(unit(test.met.at(rays).direction),
               unit(minus(test.pulled.back(), test.hand->rays()[0][0])), 1e-12);
}

TEST(DeviceHand, AWandProbesOnceForEachPress) {
  TestHand test;
  test.says.pose = DevicePose{{1, 1, 0}, {1, 0, 0, 0}};
  test.says.probes = true;
  test.update();
  test.update();
  ASSERT_EQ(test.probed.size(), 1u);
  expect_close(test.probed[0].origin, {0.5, -2, 0}, 1e-12);
  expect_close(unit(test.probed[0].direction), {0, 1, 0}, 1e-12);
  test.says.probes = false;
  test.update();
  test.says.probes = true;
  test.update();
  EXPECT_EQ(test.probed.size(), 2u);
}

TEST(DeviceHand, ALostWandLetsGoAndHasNoRay) {
  TestHand test;
  test.says.pose = DevicePose{};
  test.says.grabs = true;
  test.update();
  test.says = {};
  test.suffers = "wand: no server";
  test.update();
  EXPECT_EQ(test.releases, 1);
  EXPECT_TRUE(test.hand->rays().empty());
  EXPECT_EQ(test.hand->problems(), "wand: no server");
  EXPECT_TRUE(test.hand->has_news());
  test.suffers.clear();
  test.says.pose = DevicePose{};
  test.update();
  EXPECT_EQ(test.hand->problems(), "");
  EXPECT_EQ(test.hand->rays().size(), 1u);
}

TEST(DeviceHand, SaysThatADeviceIsGone) {
  TestHand test;
  test.says.grabs = true;
  test.update();
  test.suffers = "gamepad: is gone";
  test.is_gone = true;
  test.update();
  EXPECT_EQ(test.releases, 1);
  test.update();
  EXPECT_EQ(test.hand->problems(), "gamepad: is gone");
  EXPECT_EQ(test.grabbed.size(), 1u);
}

TEST(DeviceHand, AWandThatPointsAtNothingHoldsNothing) {
  TestHand test;
  test.is_empty = true;
  test.says.pose = DevicePose{};
  test.says.grabs = true;
  test.update();
  test.says.pose->position = {0, 2, 0};
  test.update();
  EXPECT_TRUE(test.grabbed.empty());
  EXPECT_TRUE(test.pulled.empty());
  EXPECT_FALSE(test.hand->let_go());
  EXPECT_NEAR(norm(minus(test.hand->rays()[0][1], test.hand->rays()[0][0])), 2, 1e-12);
}

/// Another device takes nothing meanwhile, also not when the first one has let go while its button
/// is still held.
TEST(DeviceHand, OneDeviceHoldsAtATime) {
  TestHand test;
  test.says.pose = DevicePose{};
  test.other_says.pose = DevicePose{{1, 1, 0}, {1, 0, 0, 0}};
  test.says.grabs = true;
  test.update();
  test.other_says.grabs = true;
  test.update();
  test.other_says.pose->position = {2, 1, 0};
  test.update();
  test.other_says.grabs = false;
  test.update();
  EXPECT_EQ(test.grabbed.size(), 1u);
  EXPECT_TRUE(test.pulled.empty());
  EXPECT_EQ(test.releases, 0) << "what the first one holds stays held";
  test.other_says.grabs = true;
  test.update();
  test.says.grabs = false;
  test.update();
  EXPECT_EQ(test.releases, 1);
  test.update();
  EXPECT_EQ(test.grabbed.size(), 1u);
  test.other_says.grabs = false;
  test.update();
  test.other_says.grabs = true;
  test.update();
  EXPECT_EQ(test.grabbed.size(), 2u);
  EXPECT_EQ(test.releases, 1);
}

TEST(DeviceHand, HasNoRayBeyondTheWorld) {
  TestHand test;
  test.says.pose = DevicePose{{9e8, 0, 0}, {1, 0, 0, 0}};
  test.update();
  EXPECT_EQ(test.hand->rays().size(), 1u);
  test.room.axes = {{{2, 0, 0}, {0, 0, 2}, {0, -2, 0}}};
  test.update();
  EXPECT_TRUE(test.hand->rays().empty());
}

/// What was taken from the middle stays where it is when the device gets a pose.
TEST(DeviceHand, AFirstPoseYanksNothing) {
  TestHand test;
  test.says.grabs = true;
  test.update();
  ASSERT_EQ(test.grabbed.size(), 1u);
  test.says.pose = DevicePose{{1, 2, 3}, {1, 0, 0, 0}};
  test.update();
  EXPECT_TRUE(test.pulled.empty());
  test.says.pose->position = {1.5, 2, 3};
  test.update();
  ASSERT_EQ(test.pulled.size(), 1u);
  expect_close(test.pulled[0], plus(test.grabbed[0].point, {0.25, 0, 0}), 1e-12);
}

/// A stick carries what is in the middle of the window, as the camera would go.
TEST(DeviceHand, AStickTakesWhatIsInTheMiddle) {
  TestHand test;
  test.says.grabs = true;
  test.update();
  ASSERT_EQ(test.grabbed.size(), 1u);
  expect_close(test.grabbed[0].point, {0, 0, 0}, 1e-12);
  test.says.move = {1, 0, 0};
  EXPECT_FALSE(test.update());
  ASSERT_EQ(test.pulled.size(), 1u);
  expect_close(test.pulled[0], {0.1, 0, 0}, 1e-12);  // half of the distance a second
  EXPECT_TRUE(test.hand->let_go());
  EXPECT_TRUE(test.update()) << "now the camera moves";
  expect_close(test.camera.target, {0.1, 0, 0}, 1e-12);
}

/// What a ray meets follows ray, cut and frame, though the same question is answered once.
TEST(SceneHand, MeetsWhatIsThereNow) {
  ViewOptions options;
  options.paused = true;
  LiveSimulation simulation(live_scene(), options, {});
  const ViewScene view = view_scene_of(simulation, options);
  std::optional<Cut> cut;
  SceneHand reach(view, simulation, [&] { return cut; });
  simulation.begin();
  frame_at(simulation, 0);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-0.1, 0.1);
  EyeRay ray;
  int met = 0;
  for (int trial = 0; trial < 60; ++trial) {
    if (trial % 3 == 0) ray = {{any(random) / 2, any(random) / 2, 0.5}, {any(random) / 9, 0, -1}};
    if (trial % 4 == 0) cut = Cut{{0, 0, any(random)}, {0, 0, 1}};
    if (trial % 8 == 0) cut.reset();
    if (trial % 5 == 0) {
      simulation.give({.kind = OrderKind::step});
      frame_at(simulation, trial / 5 + 1);
    }
    const auto& points = simulation.frames().front().points;
    const auto expected = pick(points, view.triangles, ray.origin, ray.direction, cut);
    const auto found = reach.meet(ray);
    ASSERT_EQ(found.has_value(), expected.has_value());
    if (!found) continue;
    ++met;
    EXPECT_EQ(found->point, expected->point);
    EXPECT_EQ(found->body, expected->body);
  }
  EXPECT_GT(met, 20);
  simulation.end();
}

/// A wand of a file pulls at the block of a simulation and carries a ball that pushes.
TEST(SceneHand, AWandPullsPushesAndProbes) {
  const TemporaryFolder folder;
  const std::string file = folder / "wand.txt";
  // The room is the world; the wand is 1 m before the block, then before the ball.
  std::ofstream(file) << "0 0 0 0 0 0 0 0  0 0 1  1 0 0 0  1\n"
                         "0 0 0 0 0 0 0 1  0 0 1  1 0 0 0  0\n"
                         "0 0 0 0 0 0 0 1  0.02 0 1  1 0 0 0  0\n"
                         "0 0 0 0 0 0 0 0  0 0 1  1 0 0 0  0\n"
                         "0 0 0 0 0 0 0 1  0.3 0 1  1 0 0 0  0\n"
                         "0 0 0 0 0 0 0 1  0.303 0 1  1 0 0 0  0\n";
  Scene scene = live_scene();
  scene.bodies[1].kind = BodyKind::scripted;
  scene.bodies[1].pose.position = {0.3, 0, 0};
  ViewOptions options;
  options.paused = true;
  LiveSimulation simulation(std::move(scene), options, {});
  const ViewScene view = view_scene_of(simulation, options);
  SceneHand reach(view, simulation, [] { return std::nullopt; });
  std::string probed;
  std::vector<std::unique_ptr<InputDevice>> devices;
  devices.push_back(std::make_unique<SimulatedDevice>(file));
  HandActions actions = reach.actions();
  actions.probe = [&](const EyeRay& ray) { probed = reach.probe(ray); };
  actions.place = [](const Camera&) {  // the room is the world
    return RoomPlace{{}, {}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}};
  };
  DeviceHand hand(std::move(devices), std::move(actions));
  Camera camera{.eye = {0, -2, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}};
  simulation.begin();
  frame_at(simulation, 0);
  for (int line = 0; line < 6; ++line) {
    hand.update(camera, {});
    simulation.give({.kind = OrderKind::step});
    frame_at(simulation, line + 1);
  }
  simulation.end();
  const std::vector<InputEvent>& events = simulation.log().events;
  EXPECT_EQ(probed.rfind("block at 0, 0, 0.1", 0), 0u) << probed;
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0].kind, InputKind::grab);
  EXPECT_EQ(events[0].handle.body, "block");
  expect_close(events[0].handle.center, {0, 0, 0.12}, 0.01);  // its upper face
  EXPECT_EQ(events[1].kind, InputKind::move);
  expect_close(events[1].displacement, {0.02, 0, 0}, 1e-12);
  EXPECT_EQ(events[2].kind, InputKind::release);
  EXPECT_EQ(events[3].kind, InputKind::carry);
  EXPECT_EQ(events[3].handle.body, "ball");
  expect_close(events[3].displacement, {0.003, 0, 0}, 1e-12);
}

}  // namespace
}  // namespace tetwarp::test

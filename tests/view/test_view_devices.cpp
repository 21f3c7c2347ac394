/// @file test_view_devices.cpp
/// Devices beside the mouse: what they do to a camera, and a simulated one.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <random>
#include <string>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "host/view/devices/simulated_device.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

void expect_near(const Point3& found, const Point3& expected) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], expected[axis], 1e-12);
}

/// From the front, two meters away: right is x, up is z.
const Camera front{.eye = {0, -2, 0}, .target = {0, 0, 0}, .up = {0, 0, 1}};

TEST(MovedCamera, GoesAlongItsAxes) {
  // Half of the distance, 1 m, in a second.
  const Camera moved = moved_camera(front, {{.move = {1, 0.5, -0.25}}, 0.5});
  expect_near(moved.target, {0.5, 0.125, 0.25});
  expect_near(moved.eye, {0.5, -1.875, 0.25});
  expect_near(moved.up, front.up);
  expect_near(carried_way(front, {{.move = {1, 0, 0}}, 1}), {1, 0, 0});
}

/// The scene turns to the right about the vertical axis as the hand does: the camera goes left.
TEST(MovedCamera, TurnsAboutItsTarget) {
  const Camera moved = moved_camera(front, {{.turn = {0, 1, 0}}, 1});
  expect_near(moved.eye, {-2, 0, 0});
  expect_near(moved.target, front.target);
  const Camera over = moved_camera(front, {{.turn = {1, 0, 0}}, 1});
  expect_near(over.eye, {0, 0, 2});
  expect_near(over.up, {0, 1, 0});
}

/// Whatever the hand does, distance and the right angle of the axes stay, and going back undoes a
/// turn.
TEST(MovedCamera, KeepsItsDistance) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-1, 1);
  Camera camera = front;
  for (int trial = 0; trial < 200; ++trial) {
    const Point3 turn{any(random), any(random), any(random)};
    const DeviceSpan span{{.move = {any(random), any(random), any(random)}, .turn = turn}, 0.1};
    camera = moved_camera(camera, span);
    EXPECT_NEAR(norm(minus(camera.eye, camera.target)), 2, 1e-9);
    EXPECT_NEAR(dot(camera.up, minus(camera.eye, camera.target)), 0, 1e-9);
    EXPECT_NEAR(norm(camera.up), 1, 1e-9);
  }
  const Camera still = moved_camera(camera, {{}, 1});
  expect_near(still.eye, camera.eye);
}

TEST(SimulatedDevice, ReadsItsLinesOneByOne) {
  const TemporaryFolder folder;
  const std::string path = folder / "motion.txt";
  std::ofstream(path) << "0.5  1 0 -0.25  0 1 0  1\n0.1 0 0 0 0 0 0 0\n";
  SimulatedDevice device(path);
  const auto first = device.read();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->seconds, 0.5);
  EXPECT_EQ(first->state, (DeviceState{{1, 0, -0.25}, {0, 1, 0}, true}));
  EXPECT_EQ(device.read().value().state, DeviceState{});
  EXPECT_FALSE(device.read());
  EXPECT_FALSE(device.read());
}

TEST(SimulatedDevice, HasThePoseOfAWand) {
  const TemporaryFolder folder;
  const std::string path = folder / "wand.txt";
  std::ofstream(path) << "0.1  0 0 0  0 0 0  1  1 2 3  0 0 2 0  1\n";
  SimulatedDevice device(path);
  const DeviceState state = device.read().value().state;
  EXPECT_EQ(state.pose, (DevicePose{{1, 2, 3}, {0, 0, 1, 0}}));
  EXPECT_TRUE(state.grabs);
  EXPECT_TRUE(state.probes);
}

TEST(Stick, RestsNearItsMiddle) {
  for (const double value : {0.0, 0.15, -0.15, 0.1}) EXPECT_EQ(beyond_rest(value), 0);
  EXPECT_EQ(beyond_rest(1), 1);
  EXPECT_EQ(beyond_rest(-1), -1);
  EXPECT_EQ(beyond_rest(-2), -1);
  for (double value = 0.15; value < 1; value += 0.01) {
    EXPECT_NEAR(beyond_rest(value), (value - 0.15) / 0.85, 1e-12);
    EXPECT_EQ(beyond_rest(-value), -beyond_rest(value));
  }
}

TEST(SimulatedDevice, NamesTheLineThatIsWrong) {
  const TemporaryFolder folder;
  const std::string path = folder / "motion.txt";
  for (const std::string line :
       {"", "0.1 0 0 0 0 0 0", "0.1 0 0 0 0 0 0 0 0", "0.1 2 0 0 0 0 0 0", "-1 0 0 0 0 0 0 0",
        "0.1 0 0 0 0 0 0 3", "0.1 0 0 a 0 0 0 0", "0.1 0 0 0 0 0 0 0 1 2 3 1 0 0 0",
        "0.1 0 0 0 0 0 0 0 1 2 3 1 0 0 0 2", "0.1 0 0 0 0 0 0 0 1 2 3 0 0 0 0 1"}) {
    std::ofstream(path) << "0.1 0 0 0 0 0 0 0\n" << line << "\n";
    try {
      const SimulatedDevice device(path);
      ADD_FAILURE() << line;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("line 2"), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(SimulatedDevice(folder / "nowhere"), IoError);
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_view_devices.cpp
/// Devices beside the mouse: what they do to a camera, and a simulated one.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>

#include "host/base/point3.hpp"
#include "host/view/devices/number_line.hpp"
#include "host/view/devices/simulated_device.hpp"
#include "host/view/devices/tracked_names.hpp"
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
        "0.1 0 0 0 0 0 0 0 1 2 3 1 0 0 0 2", "0.1 0 0 0 0 0 0 0 1 2 3 0 0 0 0 1",
        "0.1 0 0 0 0 0 0 0 -", "0.1 0 0 0 0 0 0 0 1 2 3 1 0 0 0 1e999",
        "0.1 0 0 0 0 0 0 0 1 2 1e300 1 0 0 0 1"}) {
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

TEST(NumberLine, HasFiniteNumbersAlone) {
  EXPECT_EQ(numbers_of(" 1 -2e3\t+.5 0x"), std::nullopt);
  EXPECT_EQ(numbers_of(" 1 -2e3\t+.5 \r"), (std::vector<double>{1, -2000, 0.5}));
  EXPECT_EQ(numbers_of(""), std::vector<double>{});
  for (const std::string word :
       {"-", "+", "+-1", "1e", "1e+", "1e999", "-1e999", "nan", "inf", "1,5", "x", "1x"}) {
    EXPECT_EQ(numbers_of("1 2 " + word), std::nullopt) << word;
    EXPECT_EQ(numbers_of(word + " 1 2"), std::nullopt) << word;
  }
}

TEST(TrackedNames, AreTakenApart) {
  const TrackedNames plain = tracked_names("Wand@host");
  EXPECT_EQ(plain.tracker + " " + plain.buttons, "Wand@host Wand@host");
  EXPECT_EQ(plain.sensor, 0);
  const TrackedNames whole = tracked_names("A b@10.0.0.2:65535#9999+Keys@my-pc.lan:1");
  EXPECT_EQ(whole.tracker + " " + whole.buttons, "A b@10.0.0.2:65535 Keys@my-pc.lan:1");
  EXPECT_EQ(whole.sensor, 9999);
}

/// Addresses that start programs, read files or listen are refused, also as a host of buttons.
TEST(TrackedNames, AreNoOtherAddresses) {
  for (const std::string name : {"Wand",
                                 "@host",
                                 "Wand@",
                                 "Wand@@host",
                                 "Wand@x-vrsh://host/program,word",
                                 "Wand@x-vrsh:host",
                                 "Wand@file:/etc/passwd",
                                 "Wand@file://name",
                                 "Wand@tcp://host",
                                 "Wand@host/program",
                                 "Wand@host name",
                                 "Wand@host;ls",
                                 "Wand@host\n",
                                 "Wand@:3883",
                                 "Wand@host:",
                                 "Wand@host:0",
                                 "Wand@host:65536",
                                 "Wand@host:-1",
                                 "Wand@host:38x3",
                                 "Wand@host:+1",
                                 "Wand@host:1:2",
                                 "Wand@host:99999999999",
                                 "x-vrsh:Wand@host"}) {
    EXPECT_THROW(tracked_names(name), std::invalid_argument) << name;
    EXPECT_THROW(tracked_names("Wand@host+" + name), std::invalid_argument) << name;
  }
  for (const std::string name : {"Wand@host#x", "Wand@host#", "Wand@host#-1", "Wand@host#10000",
                                 "Wand@host#0#1", "Wand@host+", "Wand@host+A@b#1", ""}) {
    EXPECT_THROW(tracked_names(name), std::invalid_argument) << name;
  }
}

}  // namespace
}  // namespace tetwarp::test

/// @file test_tracked_device.cpp
/// Trackers of a real VRPN server, which is a process of its own.
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include "host/base/stopwatch.hpp"
#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

constexpr double most_wait = 20;  // [s]

/// Of the loopback interface.
int unused_port() {
  const int probe = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* const any = reinterpret_cast<sockaddr*>(&address);
  const bool is_good = bind(probe, any, size) == 0 && getsockname(probe, any, &size) == 0;
  close(probe);
  return is_good ? ntohs(address.sin_port) : 0;
}

/// The program tracking_server, which ends with this.
class TrackingServer {
 public:
  explicit TrackingServer(int port)
      : lines_(popen(("'" TETWARP_TRACKING_SERVER "' " + std::to_string(port)).c_str(), "w")) {}
  TrackingServer(const TrackingServer&) = delete;
  TrackingServer& operator=(const TrackingServer&) = delete;
  ~TrackingServer() { pclose(lines_); }

  void say(const std::string& line) {
    std::fputs((line + "\n").c_str(), lines_);
    std::fflush(lines_);
  }
  void say_pose(int sensor, const DevicePose& pose) {
    std::ostringstream line;
    line.precision(17);
    const auto& [w, x, y, z] = pose.rotation;
    line << "pose " << sensor;
    for (const double part : pose.position) line << " " << part;
    line << " " << x << " " << y << " " << z << " " << w;
    say(line.str());
  }

 private:
  FILE* lines_;
};

/// Asks until it is so, or for too long.
bool comes_to(InputDevice& device, const std::function<bool(const DeviceState&)>& be) {
  const Stopwatch watch;
  while (watch.seconds() < most_wait) {
    if (be(device.read().value().state)) return true;
    usleep(1000);
  }
  return false;
}

bool has_position(const DeviceState& state, const Point3& position) {
  return state.pose && state.pose->position == position;
}

std::string at_port(const std::string& name, int port) {
  return name + "@127.0.0.1:" + std::to_string(port);
}

/// Positions are meters here and there; rotations come in another order, and at another length.
TEST(TrackedDevice, GetsPosesButtonsAndAxes) {
  const int port = unused_port();
  TrackingServer server(port);
  const auto device = open_tracked_device(at_port("Wand", port) + "#1");
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  server.say_pose(0, {{7, 7, 7}, {1, 0, 0, 0}});  // of another sensor
  for (int trial = 0; trial < 20; ++trial) {
    DevicePose pose;
    for (double& part : pose.position) part = any(random);
    for (double& part : pose.rotation) part = any(random);
    server.say_pose(1, pose);
    ASSERT_TRUE(comes_to(*device, [&](const DeviceState& state) {
      EXPECT_FALSE(has_position(state, {7, 7, 7}));
      return has_position(state, pose.position);
    }));
    const auto rotation = unit_rotation(pose.rotation).value();
    const DevicePose found = device->read().value().state.pose.value();
    for (std::size_t n = 0; n < 4; ++n) EXPECT_NEAR(found.rotation[n], rotation[n], 1e-15);
  }
  EXPECT_EQ(device->problem(), "");
  EXPECT_FALSE(device->read()->state.grabs);
  for (const bool is_down : {true, false, true}) {
    server.say(std::string("button 0 ") + (is_down ? "1" : "0"));
    EXPECT_TRUE(comes_to(*device, [&](const DeviceState& s) { return s.grabs == is_down; }));
    server.say(std::string("button 1 ") + (is_down ? "1" : "0"));
    EXPECT_TRUE(comes_to(*device, [&](const DeviceState& s) { return s.probes == is_down; }));
  }
  server.say("axes 1 0.575 -1 0.1");
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& s) { return s.move[0] == 1; }));
  const DeviceState pushed = device->read()->state;
  EXPECT_NEAR(pushed.move[2], -0.5, 1e-12);  // beyond 0.15, within which a stick rests
  EXPECT_EQ(pushed.turn[1], -1);
  EXPECT_EQ(pushed.turn[0], 0);
}

TEST(TrackedDevice, GoesOnWhenItsServerComesBack) {
  const int port = unused_port();
  const std::string name = at_port("Wand", port);
  const auto device = open_tracked_device(name);
  EXPECT_EQ(device->read()->state, DeviceState{});
  EXPECT_EQ(device->problem(), name + ": no VRPN server answers");
  for (int run = 1; run <= 2; ++run) {
    TrackingServer server(port);
    EXPECT_TRUE(comes_to(*device, [&](const DeviceState&) {
      return device->problem() == name + ": no pose of sensor 0";
    }));
    const DevicePose pose{{0.5, 0.25, 1.0 * run}, {1, 0, 0, 0}};
    server.say_pose(0, pose);
    EXPECT_TRUE(comes_to(*device, [&](const DeviceState& s) { return s.pose == pose; }));
    EXPECT_EQ(device->problem(), "");
    server.say("button 0 1");
    EXPECT_TRUE(comes_to(*device, [](const DeviceState& s) { return s.grabs; }));
    if (run == 2) break;
    server.say("axes 1 1 1 1");
    EXPECT_TRUE(comes_to(*device, [](const DeviceState& s) { return s.move[0] == 1; }));
  }
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& s) { return s == DeviceState{}; }));
  EXPECT_EQ(device->problem(), name + ": no VRPN server answers");
}

/// Buttons may have a server, and a name, of their own.
TEST(TrackedDevice, HasButtonsOfAnotherServer) {
  const int poses = unused_port(), buttons = unused_port();
  TrackingServer tracker(poses), keys(buttons);
  const auto device = open_tracked_device(at_port("Wand", poses) + "+" + at_port("Wand", buttons));
  tracker.say_pose(0, {{1, 2, 3}, {1, 0, 0, 0}});
  tracker.say("button 1 1");
  keys.say_pose(0, {{4, 5, 6}, {1, 0, 0, 0}});
  keys.say("button 0 1");
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& state) {
    return has_position(state, {1, 2, 3}) && state.grabs;
  }));
  EXPECT_FALSE(device->read()->state.probes);
}

/// A wand that is nowhere holds nothing: before its first pose, and when its tracker has ended,
/// though the buttons have a server that goes on.
TEST(TrackedDevice, HasNoButtonsWithoutAPose) {
  const int poses = unused_port(), buttons = unused_port();
  TrackingServer keys(buttons);
  const auto device = open_tracked_device(at_port("Wand", poses) + "+" + at_port("Wand", buttons));
  keys.say("button 0 1");
  keys.say("button 1 1");
  keys.say("axes 1 0 0 0");  // comes after the buttons
  ASSERT_TRUE(comes_to(*device, [](const DeviceState& state) {
    EXPECT_FALSE(state.grabs || state.probes);
    return state.move[0] == 1;
  }));
  {
    TrackingServer tracker(poses);
    tracker.say_pose(0, {{1, 2, 3}, {1, 0, 0, 0}});
    EXPECT_TRUE(comes_to(*device, [](const DeviceState& state) {
      EXPECT_EQ(state.grabs, state.pose.has_value());
      return state.pose && state.probes;
    }));
  }
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& state) {
    EXPECT_EQ(state.grabs, state.pose.has_value());
    return !state.pose;
  }));
  EXPECT_EQ(device->read()->state.move[0], 1) << "the axes are there";
}

/// A server that answers no more may be anywhere with the wand.
TEST(TrackedDevice, LetsGoWhenItsTrackerIsSilent) {
  const int port = unused_port();
  TrackingServer server(port);
  const auto device = open_tracked_device(at_port("Wand", port));
  server.say_pose(0, {{1, 2, 3}, {1, 0, 0, 0}});
  server.say("button 0 1");
  ASSERT_TRUE(comes_to(*device, [](const DeviceState& state) { return state.grabs; }));
  server.say("hang 1");
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& state) { return !state.grabs; }));
  const DeviceSpan span = device->read().value();
  EXPECT_TRUE(has_position(span.state, {1, 2, 3}));
  EXPECT_GT(span.pose_age, 1);
  EXPECT_NE(device->problem().find("no pose of sensor 0"), std::string::npos);
}

TEST(TrackedDevice, IgnoresPosesBeyondTheWorld) {
  const int port = unused_port();
  TrackingServer server(port);
  const auto device = open_tracked_device(at_port("Wand", port));
  server.say_pose(0, {{1, 2, 3}, {1, 0, 0, 0}});
  ASSERT_TRUE(comes_to(*device, [](const DeviceState& state) { return state.pose.has_value(); }));
  server.say_pose(0, {{1e300, 2, 3}, {1, 0, 0, 0}});
  server.say("button 0 1");
  EXPECT_TRUE(comes_to(*device, [](const DeviceState& state) {
    EXPECT_TRUE(has_position(state, {1, 2, 3}));
    return state.grabs;
  }));
}

TEST(TrackedDevice, RefusesAHostThatIsNone) {
  EXPECT_THROW(open_tracked_device("Wand@nowhere.invalid"), std::runtime_error);
  EXPECT_THROW(open_tracked_device("Wand@file:123"), std::runtime_error);
}

}  // namespace
}  // namespace tetwarp::test

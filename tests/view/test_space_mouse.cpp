/// @file test_space_mouse.cpp
/// 3D mice, by a daemon that this test plays.
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

#include "host/base/stopwatch.hpp"
#include "host/view/devices/space_mouse.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

/// Speaks the first version of spacenavd's protocol: events of eight int32, of which the first is 0
/// for motion, 1 for a button pressed and 2 for one released.
class SpaceDaemon {
 public:
  SpaceDaemon() : path_(folder_ / "spnav.sock") {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path_.c_str(), sizeof address.sun_path - 1);
    listens_ = socket(AF_UNIX, SOCK_STREAM, 0);
    bind(listens_, reinterpret_cast<sockaddr*>(&address), sizeof address);
    listen(listens_, 1);
    setenv("SPNAV_SOCKET", path_.c_str(), 1);
  }
  SpaceDaemon(const SpaceDaemon&) = delete;
  SpaceDaemon& operator=(const SpaceDaemon&) = delete;
  ~SpaceDaemon() {
    hang_up();
    close(listens_);
    unsetenv("SPNAV_SOCKET");
  }
  /// Whether a client came here, not to a daemon elsewhere.
  bool take_client() {
    pollfd waiting{listens_, POLLIN, 0};
    if (poll(&waiting, 1, 0) <= 0) return false;
    client_ = accept(listens_, nullptr, nullptr);
    return client_ >= 0;
  }
  void say(const std::array<std::int32_t, 8>& event) {
    ASSERT_EQ(write(client_, event.data(), sizeof event), static_cast<ssize_t>(sizeof event));
  }
  void hang_up() {
    if (client_ >= 0) close(client_);
    client_ = -1;
  }

 private:
  TemporaryFolder folder_;
  std::string path_;
  int listens_ = -1, client_ = -1;
};

TEST(SpaceMouse, CapAndButtonsMoveTurnGrabAndProbe) {
  SpaceDaemon daemon;
  std::unique_ptr<InputDevice> mouse;
  try {
    mouse = open_space_mouse();
  } catch (const std::runtime_error&) {
  }
  if (!mouse || !daemon.take_client()) GTEST_SKIP() << "libspnav does not know SPNAV_SOCKET";
  EXPECT_EQ(mouse->read().value().state, DeviceState{});
  daemon.say({0, 350, -175, 35, 700, 0, -350, 16});
  const DeviceState pushed = mouse->read().value().state;
  // The daemon's third axis is away from the user.
  EXPECT_EQ(pushed.move, (Point3{1, -0.5, -0.1}));
  EXPECT_EQ(pushed.turn, (Point3{1, 0, 1}));
  EXPECT_FALSE(pushed.grabs);
  daemon.say({1, 0, 0, 0, 0, 0, 0, 0});
  daemon.say({1, 1, 0, 0, 0, 0, 0, 0});
  EXPECT_TRUE(mouse->read().value().state.grabs);
  EXPECT_TRUE(mouse->read().value().state.probes);
  daemon.say({2, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_FALSE(mouse->read().value().state.grabs);
  EXPECT_TRUE(mouse->read().value().state.probes);
  const Stopwatch watch;  // a cap that rests says nothing
  while (mouse->read().value().state.move != Point3{} && watch.seconds() < 10) usleep(1000);
  EXPECT_EQ(mouse->read().value().state.move, Point3{});
  daemon.hang_up();
  EXPECT_FALSE(mouse->read()) << "it is gone";
  EXPECT_EQ(mouse->problem(), "spacemouse: the daemon spacenavd has ended");
}

TEST(SpaceMouse, WithoutADaemonIsNamed) {
  setenv("SPNAV_SOCKET", "/nowhere/spnav.sock", 1);
  try {
    open_space_mouse();
    GTEST_SKIP() << "a daemon answers";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "spacemouse: no daemon answers; install and start spacenavd");
  }
  unsetenv("SPNAV_SOCKET");
}

}  // namespace
}  // namespace tetwarp::test

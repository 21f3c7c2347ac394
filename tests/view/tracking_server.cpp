/// @file tracking_server.cpp
/// A VRPN server of one tracker with two sensors, buttons and axes, all called Wand.
///
///     tracking_server PORT    at the loopback interface, until the standard input ends
///
/// Lines of the standard input: pose SENSOR x y z qx qy qz qw, button NUMBER 0 or 1, axes and four
/// numbers, hang 1. Poses are repeated as trackers do, until it hangs.
#include <poll.h>
#include <unistd.h>
#include <vrpn_Analog.h>
#include <vrpn_Button.h>
#include <vrpn_Connection.h>
#include <vrpn_Tracker.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

namespace {
constexpr int period = 10;  // [ms]

struct Pose {
  std::array<double, 3> position{};
  std::array<double, 4> rotation{};
};

class Server {
 public:
  explicit Server(int port)
      : connection_(vrpn_create_server_connection(port, nullptr, nullptr, "127.0.0.1")),
        tracker_("Wand", connection_, 2),
        buttons_("Wand", connection_, 2),
        axes_("Wand", connection_, 4) {}
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server() { connection_->removeReference(); }

  void obey(const std::string& line) {
    std::istringstream words(line);
    std::string what;
    int number = 0, state = 0;
    words >> what;
    if (what == "pose") {
      words >> number;
      Pose& pose = poses_[number];
      for (double& part : pose.position) words >> part;
      for (double& part : pose.rotation) words >> part;
    } else if (what == "button") {
      words >> number >> state;
      buttons_.set_button(number, state);
    } else if (what == "axes") {
      for (int axis = 0; axis < 4; ++axis) words >> axes_.channels()[axis];
    } else if (what == "hang") {
      words >> is_hanging_;
    }
  }

  void serve() {
    if (is_hanging_) return;
    timeval now{};
    vrpn_gettimeofday(&now, nullptr);
    for (const auto& [sensor, pose] : poses_) {
      tracker_.report_pose(sensor, now, pose.position.data(), pose.rotation.data());
    }
    axes_.report();
    tracker_.mainloop();
    buttons_.mainloop();
    axes_.mainloop();
    connection_->mainloop();
  }

 private:
  vrpn_Connection* connection_;
  vrpn_Tracker_Server tracker_;
  vrpn_Button_Server buttons_;
  vrpn_Analog_Server axes_;
  std::map<int, Pose> poses_;
  bool is_hanging_ = false;
};
}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) return 1;
  Server server(std::atoi(arguments[1]));
  std::string text;
  while (true) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, period) > 0) {
      char bytes[512];
      const ssize_t count = read(STDIN_FILENO, bytes, sizeof bytes);
      if (count <= 0) return 0;
      text.append(bytes, static_cast<std::size_t>(count));
    }
    for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
      server.obey(text.substr(0, end));
      text.erase(0, end + 1);
    }
    server.serve();
  }
}

/// @file space_mouse_spnav.cpp
/// Events of the daemon, whose axes are to the right, up and away from the user.
#include <spnav.h>
#include <sys/socket.h>

#include <algorithm>
#include <stdexcept>

#include "host/base/stopwatch.hpp"
#include "host/view/devices/space_mouse.hpp"

namespace tetwarp::view {
namespace {
constexpr double full = 350;           // about the largest number of an axis
constexpr double rest_seconds = 0.25;  // the cap rests where the daemon says nothing for so long

class SpaceMouse : public InputDevice {
 public:
  SpaceMouse() {
    if (spnav_open() != 0) {
      throw std::runtime_error("spacemouse: no daemon answers; install and start spacenavd");
    }
  }
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;
  ~SpaceMouse() override { spnav_close(); }

  std::optional<DeviceSpan> read() override {
    spnav_event event;
    while (spnav_poll_event(&event) != 0) take(event);
    char next = 0;
    const auto waiting = recv(spnav_fd(), &next, 1, MSG_PEEK | MSG_DONTWAIT);
    has_ended_ = waiting == 0;
    if (has_ended_) return std::nullopt;
    if (said_.seconds() > rest_seconds) state_.move = state_.turn = {0, 0, 0};
    const DeviceSpan span{state_, std::min(since_.seconds(), most_span)};
    since_ = {};
    return span;
  }
  std::string problem() const override {
    return has_ended_ ? "spacemouse: the daemon spacenavd has ended" : "";
  }

 private:
  static double share(int value) { return std::clamp(value / full, -1.0, 1.0); }

  void take(const spnav_event& event) {
    if (event.type == SPNAV_EVENT_MOTION) {
      const spnav_event_motion& by = event.motion;
      state_.move = {share(by.x), share(by.y), -share(by.z)};
      state_.turn = {share(by.rx), share(by.ry), -share(by.rz)};
      said_ = {};
    } else if (event.type == SPNAV_EVENT_BUTTON) {
      if (event.button.bnum == 0) state_.grabs = event.button.press != 0;
      if (event.button.bnum == 1) state_.probes = event.button.press != 0;
    }
  }

  DeviceState state_;
  bool has_ended_ = false;
  Stopwatch since_, said_;
};
}  // namespace

std::unique_ptr<InputDevice> open_space_mouse() {
  return std::make_unique<SpaceMouse>();
}

}  // namespace tetwarp::view

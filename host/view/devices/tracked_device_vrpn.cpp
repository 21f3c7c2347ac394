/// @file tracked_device_vrpn.cpp
/// Messages of VRPN's trackers, buttons and analogs, which connect again by themselves.
#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <vrpn_Analog.h>
#include <vrpn_Button.h>
#include <vrpn_Tracker.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "host/base/stopwatch.hpp"
#include "host/view/devices/tracked_device.hpp"
#include "host/view/devices/tracked_names.hpp"

namespace tetwarp::view {
namespace {
constexpr double silent_seconds = 3;

/// VRPN would look its host up again and again, and wait for that, while no server answers.
/// @param device  NAME@HOST or NAME@HOST:PORT
/// @returns the same with the address of the host
std::string with_address(const std::string& device) {
  const std::size_t at = device.find('@') + 1;
  const std::size_t colon = std::min(device.find(':', at), device.size());
  addrinfo wanted{};
  wanted.ai_family = AF_INET;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  char address[INET_ADDRSTRLEN];
  const std::string host = device.substr(at, colon - at);
  if (getaddrinfo(host.c_str(), nullptr, &wanted, &found) != 0) {
    throw std::runtime_error("'" + device + "': there is no such host");
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owned(found, freeaddrinfo);
  const auto* const place = reinterpret_cast<const sockaddr_in*>(found->ai_addr);
  return device.substr(0, at) + inet_ntop(AF_INET, &place->sin_addr, address, sizeof address) +
         device.substr(colon);
}

class TrackedDevice : public InputDevice {
 public:
  explicit TrackedDevice(TrackedNames names)
      : names_(std::move(names)),
        tracker_(with_address(names_.tracker).c_str()),
        buttons_(with_address(names_.buttons).c_str()),
        axes_(with_address(names_.buttons).c_str()) {
    check(tracker_, names_.tracker);
    check(buttons_, names_.buttons);
    // The window says so.
    tracker_.shutup = buttons_.shutup = axes_.shutup = true;
    if (tracker_.register_change_handler(this, take_pose, names_.sensor) != 0) {
      throw std::runtime_error("'" + names_.tracker + "': VRPN has no sensor " +
                               std::to_string(names_.sensor));
    }
    buttons_.register_change_handler(this, take_button);
    buttons_.register_states_handler(this, take_buttons);
    axes_.register_change_handler(this, take_axes);
  }
  TrackedDevice(const TrackedDevice&) = delete;
  TrackedDevice& operator=(const TrackedDevice&) = delete;

  std::optional<DeviceSpan> read() override {
    tracker_.mainloop();
    buttons_.mainloop();
    axes_.mainloop();
    if (!is_connected(tracker_)) state_.pose.reset();
    if (!is_connected(buttons_)) {
      state_.grabs = state_.probes = false;
      state_.move = state_.turn = {0, 0, 0};
    }
    note_problem();
    DeviceSpan span{state_, std::min(since_.seconds(), most_span), heard_.seconds()};
    // A wand that is nowhere, or may be elsewhere by now, holds nothing.
    if (!state_.pose || is_silent()) span.state.grabs = span.state.probes = false;
    since_ = {};
    return span;
  }
  std::string problem() const override { return problem_; }

 private:
  static void check(vrpn_BaseClass& device, const std::string& name) {
    const vrpn_Connection* const connection = device.connectionPtr();
    if (connection == nullptr || !connection->doing_okay()) {
      throw std::runtime_error("'" + name + "': VRPN cannot connect");
    }
  }
  bool is_silent() const { return heard_.seconds() > silent_seconds; }
  static bool is_connected(vrpn_BaseClass& device) { return device.connectionPtr()->connected(); }

  void note_problem() {
    problem_.clear();
    if (!is_connected(tracker_)) {
      problem_ = names_.tracker + ": no VRPN server answers";
    } else if (!state_.pose || is_silent()) {
      problem_ = names_.tracker + ": no pose of sensor " + std::to_string(names_.sensor);
    } else if (!is_connected(buttons_)) {
      problem_ = names_.buttons + ": no VRPN server answers";
    }
  }

  static void VRPN_CALLBACK take_pose(void* device, const vrpn_TRACKERCB said) {
    auto* const self = static_cast<TrackedDevice*>(device);
    const auto& [x, y, z, w] = said.quat;
    const auto pose = device_pose({said.pos[0], said.pos[1], said.pos[2]}, {w, x, y, z});
    if (!pose) return;
    self->state_.pose = pose;
    self->heard_ = {};
  }

  void press(vrpn_int32 button, vrpn_int32 state) {
    if (button == 0) state_.grabs = state != 0;
    if (button == 1) state_.probes = state != 0;
  }
  static void VRPN_CALLBACK take_button(void* device, const vrpn_BUTTONCB said) {
    static_cast<TrackedDevice*>(device)->press(said.button, said.state);
  }
  static void VRPN_CALLBACK take_buttons(void* device, const vrpn_BUTTONSTATESCB said) {
    for (vrpn_int32 button = 0; button < said.num_buttons; ++button) {
      static_cast<TrackedDevice*>(device)->press(button, said.states[button]);
    }
  }

  static void VRPN_CALLBACK take_axes(void* device, const vrpn_ANALOGCB said) {
    const auto axis = [&](vrpn_int32 channel) {
      const bool is_there = channel < said.num_channel && std::isfinite(said.channel[channel]);
      return is_there ? beyond_rest(said.channel[channel]) : 0;
    };
    DeviceState& state = static_cast<TrackedDevice*>(device)->state_;
    state.move = {axis(0), 0, -axis(1)};
    state.turn = {-axis(3), axis(2), 0};
  }

  TrackedNames names_;
  vrpn_Tracker_Remote tracker_;
  vrpn_Button_Remote buttons_;
  vrpn_Analog_Remote axes_;
  DeviceState state_;
  std::string problem_;
  Stopwatch since_, heard_;
};
}  // namespace

std::unique_ptr<InputDevice> open_tracked_device(const std::string& name) {
  return std::make_unique<TrackedDevice>(tracked_names(name));
}

}  // namespace tetwarp::view

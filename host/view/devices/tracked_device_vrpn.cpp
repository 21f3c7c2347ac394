/// @file tracked_device_vrpn.cpp
/// Messages of VRPN's trackers, buttons and analogs, which connect again by themselves.
#include <vrpn_Analog.h>
#include <vrpn_Button.h>
#include <vrpn_Tracker.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host/base/point3.hpp"
#include "host/base/stopwatch.hpp"
#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::view {
namespace {
constexpr double silent_seconds = 3;

struct TrackedNames {
  std::string tracker, buttons;
  vrpn_int32 sensor = 0;
};

TrackedNames names_of(const std::string& name) {
  TrackedNames names;
  const std::size_t plus_sign = std::min(name.find('+'), name.size());
  const std::string first = name.substr(0, plus_sign);
  const std::size_t hash = std::min(first.find('#'), first.size());
  names.tracker = first.substr(0, hash);
  names.buttons = plus_sign < name.size() ? name.substr(plus_sign + 1) : names.tracker;
  bool is_good = true;
  if (hash < first.size()) {
    const char* const end = first.data() + first.size();
    const auto [past, error] = std::from_chars(first.data() + hash + 1, end, names.sensor);
    is_good = error == std::errc() && past == end && names.sensor >= 0;
  }
  for (const std::string& device : {names.tracker, names.buttons}) {
    const std::size_t sign = device.find('@');
    is_good = is_good && sign != std::string::npos && sign > 0 && sign + 1 < device.size();
  }
  if (!is_good) {
    throw std::runtime_error("'" + name +
                             "': no tracker; expected "
                             "TRACKER@HOST[:PORT][#SENSOR][+BUTTONS@HOST[:PORT]]");
  }
  return names;
}

class TrackedDevice : public InputDevice {
 public:
  explicit TrackedDevice(TrackedNames names)
      : names_(std::move(names)),
        tracker_(names_.tracker.c_str()),
        buttons_(names_.buttons.c_str()),
        axes_(names_.buttons.c_str()) {
    check(tracker_, names_.tracker);
    check(buttons_, names_.buttons);
    // The window says so.
    tracker_.shutup = buttons_.shutup = axes_.shutup = true;
    tracker_.register_change_handler(this, take_pose, names_.sensor);
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
    const DeviceSpan span{state_, std::min(since_.seconds(), most_span)};
    since_ = {};
    return span;
  }
  std::string problem() const override { return problem_; }

 private:
  static void check(vrpn_BaseClass& device, const std::string& name) {
    const vrpn_Connection* const connection = device.connectionPtr();
    if (connection == nullptr || !connection->doing_okay()) {
      throw std::runtime_error("'" + name + "': VRPN finds no such host");
    }
  }
  static bool is_connected(vrpn_BaseClass& device) { return device.connectionPtr()->connected(); }

  void note_problem() {
    problem_.clear();
    if (!is_connected(tracker_)) {
      problem_ = names_.tracker + ": no VRPN server answers";
    } else if (!state_.pose || heard_.seconds() > silent_seconds) {
      problem_ = names_.tracker + ": no pose of sensor " + std::to_string(names_.sensor);
    } else if (!is_connected(buttons_)) {
      problem_ = names_.buttons + ": no VRPN server answers";
    }
  }

  static void VRPN_CALLBACK take_pose(void* device, const vrpn_TRACKERCB said) {
    auto* const self = static_cast<TrackedDevice*>(device);
    const auto& [x, y, z, w] = said.quat;
    const Point3 position{said.pos[0], said.pos[1], said.pos[2]};
    const auto rotation = unit_rotation({w, x, y, z});
    if (!is_finite(position) || !rotation) return;
    self->state_.pose = DevicePose{position, *rotation};
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
  return std::make_unique<TrackedDevice>(names_of(name));
}

}  // namespace tetwarp::view

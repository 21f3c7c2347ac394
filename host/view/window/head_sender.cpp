/// @file head_sender.cpp
/// Lines of numbers, and a device that is asked often.
#include "host/view/window/head_sender.hpp"

#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "host/view/devices/number_line.hpp"
#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::view {
namespace {
constexpr double ask_seconds = 0.005, repeat_seconds = 0.5;
constexpr double fresh_seconds = 1;  // of a pose that is repeated

std::optional<HeadPose> head_of(const std::string& line) {
  const auto numbers = numbers_of(line);
  if (!numbers || (numbers->size() != 3 && numbers->size() != 7)) return std::nullopt;
  std::array<double, 4> rotation{1, 0, 0, 0};
  std::copy(numbers->begin() + 3, numbers->end(), rotation.begin());
  const auto pose = device_pose({(*numbers)[0], (*numbers)[1], (*numbers)[2]}, rotation);
  if (!pose) return std::nullopt;
  return HeadPose{pose->position, pose->rotation};
}
}  // namespace

void send_head_lines(std::istream& lines, ScreenLink& link) {
  std::string line;
  for (std::int64_t number = 1; std::getline(lines, line); ++number) {
    const std::optional<HeadPose> head = head_of(line);
    if (!head) {
      throw std::runtime_error("standard input: line " + std::to_string(number) +
                               " is not x y z or x y z qw qx qy qz");
    }
    link.send(HeadMessage{*head});
    while (link.receive(0)) {
    }
  }
}

void send_tracked_head(const std::string& name,
                       ScreenLink& link,
                       const volatile std::sig_atomic_t& is_interrupted) {
  const std::unique_ptr<InputDevice> tracker = open_tracked_device(name);
  std::string said;
  std::optional<DevicePose> sent;
  Stopwatch since_sent;
  while (is_interrupted == 0) {
    const DeviceSpan span = tracker->read().value();
    const std::optional<DevicePose>& pose = span.state.pose;
    const std::string problem = tracker->problem();
    const bool is_due = pose != sent || since_sent.seconds() > repeat_seconds;
    if (pose && is_due && span.pose_age < fresh_seconds) {
      link.send(HeadMessage{{pose->position, pose->rotation}});
      sent = pose;
      since_sent = {};
    }
    const std::string news = problem.empty() ? name + ": the head is tracked" : problem;
    if (news != said) std::cerr << "tetwarp: " << news << std::endl;
    said = news;
    link.receive(ask_seconds);
  }
}

}  // namespace tetwarp::view

/// @file head_sender.cpp
/// Lines of numbers, and a device that is asked often.
#include "host/view/window/head_sender.hpp"

#include <algorithm>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "host/view/devices/tracked_device.hpp"

namespace tetwarp::view {
namespace {
constexpr double ask_seconds = 0.005, repeat_seconds = 0.5;

std::optional<HeadPose> head_of(const std::string& line) {
  std::istringstream words(line);
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  if (!words.eof() || (numbers.size() != 3 && numbers.size() != 7)) return std::nullopt;
  HeadPose head;
  std::copy_n(numbers.begin(), 3, head.position.begin());
  if (numbers.size() == 3) return head;
  const auto rotation = unit_rotation({numbers[3], numbers[4], numbers[5], numbers[6]});
  if (!rotation) return std::nullopt;
  head.rotation = *rotation;
  return head;
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
    const std::optional<DevicePose> pose = tracker->read()->state.pose;
    const std::string problem = tracker->problem();
    const bool is_due = pose != sent || since_sent.seconds() > repeat_seconds;
    if (problem.empty() && is_due) {
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

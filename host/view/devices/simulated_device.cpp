/// @file simulated_device.cpp
/// Lines of numbers.
#include "host/view/devices/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <tetwarp/error.hpp>

#include "host/view/devices/number_line.hpp"

namespace tetwarp::view {
namespace {
bool is_share(double value) {
  return std::abs(value) <= 1;
}

constexpr std::size_t stick_numbers = 8, wand_numbers = 16;

bool read_span(const std::string& line, DeviceSpan& span) {
  const auto found = numbers_of(line);
  if (!found) return false;
  const std::vector<double>& numbers = *found;
  const bool is_wand = numbers.size() == wand_numbers;
  if (numbers.size() != stick_numbers && !is_wand) return false;
  const auto is_flag = [&](std::size_t n) { return numbers[n] == 0 || numbers[n] == 1; };
  span.seconds = numbers[0];
  std::copy_n(numbers.begin() + 1, 3, span.state.move.begin());
  std::copy_n(numbers.begin() + 4, 3, span.state.turn.begin());
  span.state.grabs = numbers[7] == 1;
  if (is_wand) {
    span.state.pose = device_pose({numbers[8], numbers[9], numbers[10]},
                                  {numbers[11], numbers[12], numbers[13], numbers[14]});
    span.state.probes = numbers[15] == 1;
    if (!span.state.pose || !is_flag(15)) return false;
  }
  return is_flag(7) && span.seconds >= 0 && span.seconds <= 10 &&
         std::ranges::all_of(span.state.move, is_share) &&
         std::ranges::all_of(span.state.turn, is_share);
}
}  // namespace

SimulatedDevice::SimulatedDevice(const std::string& path) {
  std::ifstream file(path);
  if (!file)
    throw IoError(
        path, "",
        "cannot be opened; --devices takes gamepad, spacemouse, wand=NAME@HOST or a file");
  std::string line;
  for (int n = 1; std::getline(file, line); ++n) {
    if (!read_span(line, spans_.emplace_back())) {
      throw IoError(path, "",
                    "line " + std::to_string(n) +
                        " is not: seconds, move x y z, turn x y z (-1 to 1), grabs 0 or 1, and of "
                        "a wand its place x y z, rotation qw qx qy qz, probes 0 or 1");
    }
  }
}

std::optional<DeviceSpan> SimulatedDevice::read() {
  if (next_ == spans_.size()) return std::nullopt;
  return spans_[next_++];
}

}  // namespace tetwarp::view

/// @file simulated_device.cpp
/// Lines of numbers.
#include "host/view/devices/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <tetwarp/error.hpp>

namespace tetwarp::view {
namespace {
bool is_share(double value) {
  return std::abs(value) <= 1;
}

bool read_span(const std::string& line, DeviceSpan& span) {
  std::istringstream words(line);
  int grabs = 0;
  std::string rest;
  words >> span.seconds;
  for (double& part : span.state.move) words >> part;
  for (double& part : span.state.turn) words >> part;
  words >> grabs;
  span.state.grabs = grabs == 1;
  return !words.fail() && !(words >> rest) && (grabs == 0 || grabs == 1) && span.seconds >= 0 &&
         span.seconds <= 10 && std::ranges::all_of(span.state.move, is_share) &&
         std::ranges::all_of(span.state.turn, is_share);
}
}  // namespace

SimulatedDevice::SimulatedDevice(const std::string& path) {
  std::ifstream file(path);
  if (!file)
    throw IoError(path, "", "cannot be opened; --devices takes gamepad, spacemouse or a file");
  std::string line;
  for (int n = 1; std::getline(file, line); ++n) {
    if (!read_span(line, spans_.emplace_back())) {
      throw IoError(path, "",
                    "line " + std::to_string(n) +
                        " is not: seconds, move x y z, turn x y z (-1 to 1), grabs 0 or 1");
    }
  }
}

std::optional<DeviceSpan> SimulatedDevice::read() {
  if (next_ == spans_.size()) return std::nullopt;
  return spans_[next_++];
}

}  // namespace tetwarp::view

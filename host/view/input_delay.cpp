/// @file input_delay.cpp
/// Mean and largest of the delays.
#include "host/view/input_delay.hpp"

#include <algorithm>
#include <cstdio>

namespace tetwarp::view {

void InputDelay::drawn(const std::optional<InputTime>& input) {
  if (!input || input == last_) return;
  last_ = input;
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - *input).count();
  ++count_;
  sum_ += seconds;
  most_ = std::max(most_, seconds);
}

std::string InputDelay::text() const {
  if (count_ == 0) return {};
  char line[120];
  std::snprintf(
      line, sizeof line, "input to picture: %lld pulls, %.0f ms in the mean, %.0f at most",
      static_cast<long long>(count_), 1000 * sum_ / static_cast<double>(count_), 1000 * most_);
  return line;
}

}  // namespace tetwarp::view

/// @file input_delay.hpp
/// InputDelay: how long it takes from the mouse to the picture that shows what it did.
#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace tetwarp::view {

using InputTime = std::chrono::steady_clock::time_point;

/// Of pulls, from the event to the end of the first picture of a state that a step with it made.
class InputDelay {
 public:
  /// A picture is drawn. @param input  of the newest pull in its state; each counts once
  void drawn(const std::optional<InputTime>& input);
  /// A line about them, or empty.
  std::string text() const;

 private:
  std::optional<InputTime> last_;
  std::int64_t count_ = 0;
  double sum_ = 0, most_ = 0;  ///< [s]
};

}  // namespace tetwarp::view

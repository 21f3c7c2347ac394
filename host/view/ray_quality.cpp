/// @file ray_quality.cpp
/// Levels of which each takes a half to a third of the time of the one before.
#include "host/view/ray_quality.hpp"

#include <algorithm>
#include <array>

namespace tetwarp::view {
namespace {
constexpr std::array<RaySpacing, 7> levels{
    {{1, 1}, {2, 1}, {2, 1.5}, {3, 2}, {4, 3}, {5, 4}, {6, 6}}};
constexpr std::size_t software_level = 4, resting_level = 2;
constexpr double goal = 1.0 / 15;     // [s]
constexpr double quick = 0.3 * goal;  // the next finer level takes at most 3 times as long
constexpr int most_quick = 5;
constexpr double slow = 1.0;  // [s]
constexpr int most_slow = 5;
}  // namespace

RayQuality::RayQuality(bool is_software) : level_(is_software ? software_level : 0) {}

void RayQuality::drew(double seconds) {
  quick_ = seconds < quick ? quick_ + 1 : 0;
  slow_ = seconds > slow ? slow_ + 1 : 0;
  if (seconds > goal && level_ + 1 < levels.size()) ++level_;
  if (quick_ < most_quick) return;
  quick_ = 0;
  if (level_ > 0) --level_;
}

RaySpacing RayQuality::moving() const {
  return levels[level_];
}

bool RayQuality::gives_up() const {
  return slow_ >= most_slow;
}

RaySpacing RayQuality::resting() const {
  return levels[std::min(level_, resting_level)];
}

}  // namespace tetwarp::view

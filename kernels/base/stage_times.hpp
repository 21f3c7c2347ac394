/// @file stage_times.hpp
/// Seconds per stage label, as the executors measure them.
#pragma once
#include <string_view>
#include <utility>
#include <vector>

namespace tetwarp {

/// Whether an executor measures its stages, which costs two readings of a clock per stage, and two
/// records of events on a device.
enum class StageClocks { off, on };

/// Sum of seconds by label. Labels are string literals of the stages: they are not copied.
class StageTimes {
 public:
  void add(std::string_view label, double seconds) {
    for (auto& [known, sum] : sums_) {
      if (known == label) {
        sum += seconds;
        return;
      }
    }
    sums_.emplace_back(label, seconds);
  }
  double of(std::string_view label) const {
    for (const auto& [known, sum] : sums_) {
      if (known == label) return sum;
    }
    return 0;
  }
  void clear() { sums_.clear(); }

 private:
  std::vector<std::pair<std::string_view, double>> sums_;
};

}  // namespace tetwarp

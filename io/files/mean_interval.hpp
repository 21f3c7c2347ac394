/// @file mean_interval.hpp
/// What images of several steps keep of their times.
#pragma once
#include <vector>

namespace tetwarp {

/// The mean interval of times; 1 of a single one, and of those that do not increase on the whole.
inline double mean_interval(const std::vector<double>& times) {
  if (times.size() < 2) return 1;
  const double mean = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  return mean > 0 ? mean : 1;
}

}  // namespace tetwarp

/// @file sample_level.hpp
/// A sample minus a threshold. Samples above the threshold are foreground.
#pragma once
#include <limits>
#include <type_traits>

namespace tetwarp {

/// The difference has the exact sign, also that of integers with more digits than a double. It is
/// not a number where the sample is none.
template <class T>
double level_of(T sample, double threshold) {
  if constexpr (std::is_integral_v<T> && sizeof(T) == 8) {
    static_assert(std::numeric_limits<long double>::digits >= 64);
    return static_cast<double>(static_cast<long double>(sample) - threshold);
  } else {
    return static_cast<double>(sample) - threshold;
  }
}

}  // namespace tetwarp

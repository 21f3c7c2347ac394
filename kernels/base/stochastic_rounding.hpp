/// @file stochastic_rounding.hpp
/// Rounding to integers without bias, by pseudo-random numbers that depend on a number's position
/// alone: the same bits on every back end, with any number of threads, and in a part of an array.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// 64 pseudo-random bits: entry `index` of the sequence of SplitMix64 with seed 0.
/// Source: G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number Generators",
/// OOPSLA 2014.
TETWARP_HD std::uint64_t splitmix64(std::uint64_t index) {
  std::uint64_t bits = (index + 1) * 0x9e3779b97f4a7c15;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

/// The whole number below or above a value; the one above with a probability equal to the value's
/// fraction, so that the expected error is zero and its standard deviation at most 0.5. Whole
/// numbers stay as they are.
/// @param index  position of the value in its array; chooses the pseudo-random number
TETWARP_HD double stochastically_rounded(double value, std::uint64_t index) {
  const double below = floor(value);
  const double threshold = static_cast<double>(splitmix64(index) >> 11) * 0x1p-53;
  return value - below > threshold ? below + 1 : below;
}

/// What storing as integers added to a sum of numbers.
struct RoundingChange {
  static constexpr double quantum = 0x1p-32;
  std::int64_t rounding;  ///< by rounding to whole numbers [quantum]
  std::int64_t clipping;  ///< then by clipping to the limits of the type
  std::int64_t clipped;   ///< numbers beyond these limits
};

}  // namespace tetwarp

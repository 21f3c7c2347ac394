/// @file counter_hash.hpp
/// Pseudo-random numbers as a function of a counter, the same with every compiler and library.
#pragma once
#include <cstdint>

namespace tetwarp {

/// 64 pseudo-random bits of a counter.
/// Source: the finalizer of G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable Pseudorandom Number
/// Generators", OOPSLA 2014.
constexpr std::uint64_t hash_of(std::uint64_t counter) {
  std::uint64_t bits = counter + 0x9e3779b97f4a7c15;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

/// The hash as a number in [0, 1).
constexpr double unit_of(std::uint64_t counter) {
  return static_cast<double>(hash_of(counter) >> 11) * 0x1p-53;
}

}  // namespace tetwarp

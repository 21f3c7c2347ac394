/// @file pair_limit.hpp
/// How many pairs detection takes memory for.
#pragma once
#include <cstdint>
#include <limits>
#include <string>

#include "host/collide/detector.hpp"

namespace tetwarp {

constexpr std::int64_t unlimited = std::numeric_limits<std::int64_t>::max();

/// Of triangles, capsules and spheres whose boxes overlap. Steps that a simulation can use have 20
/// to 100 per item.
inline std::int64_t most_pairs(std::int64_t items) {
  return 8'000'000 + 200 * items;
}

/// @throws TooManyPairs
inline void check_count(std::int64_t count, std::int64_t most) {
  if (count <= most) return;
  throw TooManyPairs("more than " + std::to_string(most) +
                     " pairs come near each other in one motion of the surfaces");
}

}  // namespace tetwarp

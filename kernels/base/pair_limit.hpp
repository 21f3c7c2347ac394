/// @file pair_limit.hpp
/// The largest number of pairs that detection stores.
#pragma once
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

namespace tetwarp {

/// More pairs than the limit: the motion is too fast, or too much of the surfaces is near each
/// other.
class TooManyPairs : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

constexpr std::int64_t unlimited = std::numeric_limits<std::int64_t>::max();

/// Limit for pairs of items whose boxes overlap. Usual steps of simulations have 20 to 100 pairs
/// per item.
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

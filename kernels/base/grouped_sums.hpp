/// @file grouped_sums.hpp
/// Exclusive sums in two levels, as one kernel can compute them.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

constexpr int sum_shift = 8;
constexpr int sum_group = 1 << sum_shift;  ///< threads of a block that sums, counts per group

/// Number of groups of 2^shift counts for the sums of `count` counts.
TETWARP_HD std::int64_t group_count(std::int64_t count, int shift = sum_shift) {
  return (count >> shift) + 1;
}

/// The sum of all counts before each of them: of those in its group, and of the groups before.
struct GroupedSums {
  View<std::int64_t> within;  ///< shape [count + 1]
  View<std::int64_t>
      groups;             ///< shape [group_count(count, shift) + 1]; the last entry is the total
  std::int64_t size;      ///< count + 1, as of an array of offsets
  int shift = sum_shift;  ///< a group has 2^shift counts

  /// The sum before count i; of all counts for i = count.
  TETWARP_HD std::int64_t operator[](std::int64_t i) const {
    return within[i] + groups[i >> shift];
  }
  TETWARP_HD std::int64_t total() const { return groups[group_count(size - 1, shift)]; }
};

}  // namespace tetwarp

/// @file lane_sums.hpp
/// Sums of one index over lanes of a warp, by one thread.
#pragma once
#include <cstdint>

namespace tetwarp {

/// The sum of op.part(i, lane) over Op::lanes lanes, a power of two, by the tree of a warp: each
/// half is added to the other.
template <class Op>
typename Op::Sum summed_by_lanes(const Op& op, std::int64_t i) {
  typename Op::Sum sums[Op::lanes];
  for (int lane = 0; lane < Op::lanes; ++lane) sums[lane] = op.part(i, lane);
  for (int step = Op::lanes / 2; step > 0; step /= 2) {
    for (int lane = 0; lane < step; ++lane) sums[lane] += sums[lane + step];
  }
  return sums[0];
}

}  // namespace tetwarp

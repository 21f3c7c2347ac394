/// @file plain_sums.hpp
/// Sums of one pass over a vector.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Plain numbers, added in the executor's fixed tree.
template <int count>
struct PlainSums {
  double value[count] = {};

  TETWARP_HD PlainSums& operator+=(const PlainSums& other) {
    for (int k = 0; k < count; ++k) value[k] += other.value[k];
    return *this;
  }
};

}  // namespace tetwarp

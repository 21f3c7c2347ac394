/// @file plain_sums.hpp
/// Several sums accumulated in one reduction.
#pragma once
#include "kernels/base/hd.hpp"

namespace tetwarp {

/// Sums that an executor's reduction adds component by component, in its fixed tree.
template <int count>
struct PlainSums {
  double value[count] = {};

  TETWARP_HD PlainSums& operator+=(const PlainSums& other) {
    for (int k = 0; k < count; ++k) value[k] += other.value[k];
    return *this;
  }
};

}  // namespace tetwarp

/// @file four_lanes.cuh
/// Four lanes of a warp that compute one item together.
#pragma once
#include <cstring>

#include "kernels/base/hd.hpp"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// How an op exchanges numbers with the other lanes of its item. All four call each function.
struct FourLanes {
  int lane;       ///< 0 to 3
  unsigned mask;  ///< the four within their warp

  /// The value of another lane, of one or more numbers of 64 bits.
  template <class T>
  TETWARP_HD T of(int other, T value) const {
#if defined(__CUDA_ARCH__)
    constexpr int words = sizeof(T) / sizeof(double);
    static_assert(sizeof(T) == words * sizeof(double));
    double word[words];
    memcpy(word, &value, sizeof(T));
    for (int k = 0; k < words; ++k) word[k] = __shfl_sync(mask, word[k], other, 4);
    memcpy(&value, word, sizeof(T));
#elif !defined(__CUDACC__)
    value = __shfl_sync(mask, value, other, 4);
#endif
    return value;
  }
  /// Whether all lanes vote yes.
  TETWARP_HD bool all(bool vote) const {
#if defined(__CUDA_ARCH__) || !defined(__CUDACC__)
    return __all_sync(mask, vote) != 0;
#else
    return vote;
#endif
  }
};

/// The four lanes of this thread.
__device__ __forceinline__ FourLanes four_lanes() {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  return {lane % 4, 15u << (lane & ~3)};
}

/// Lanes per item: Op::lanes, else one.
template <class Op>
constexpr int lanes_of = [] {
  if constexpr (requires { Op::lanes; }) return Op::lanes;
  return 1;
}();

}  // namespace tetwarp

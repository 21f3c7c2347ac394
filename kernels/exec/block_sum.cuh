/// @file block_sum.cuh
/// Sums over the threads of a block by a fixed tree.
#pragma once
#include <cstring>

#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr int sum_threads = 128;
constexpr int sum_warps = sum_threads / 32;

/// Applies `exchange`, of one number of float64, to each word of a sum.
/// @pre all lanes of the warp call it
template <class Sum, class Exchange>
__device__ __forceinline__ Sum exchanged(const Sum& mine, const Exchange& exchange) {
  constexpr int words = sizeof(Sum) / sizeof(double);
  static_assert(sizeof(Sum) == words * sizeof(double));
  double word[words];
  memcpy(word, &mine, sizeof(Sum));
  for (int k = 0; k < words; ++k) word[k] = exchange(word[k]);
  Sum other;
  memcpy(&other, word, sizeof(Sum));
  return other;
}

/// Sum over groups of successive lanes of a warp by a fixed tree; valid in the first lane of each.
/// @tparam lanes  of a group: 32, or a smaller power of two
template <int lanes = 32, class Sum>
__device__ __forceinline__ Sum warp_sum(Sum mine) {
  for (unsigned step = lanes / 2; step > 0; step /= 2) {
    mine += exchanged(mine, [=](double word) { return __shfl_down_sync(~0u, word, step, lanes); });
  }
  return mine;
}

/// The value of the first lane.
template <class Sum>
__device__ __forceinline__ Sum shuffled_from_first(const Sum& mine) {
  return exchanged(mine, [](double word) { return __shfl_sync(~0u, word, 0); });
}

/// Sum over the threads of a block by a fixed tree, returned to every thread. All of them have
/// evaluated their terms when any of them returns.
/// @param of_warp  scratch in shared memory, shape [threads / 32]
/// @pre blockDim.x is `threads`, and all threads of the block call it
template <int threads = sum_threads, class Sum>
__device__ __forceinline__ Sum block_sum(Sum mine, Sum* of_warp) {
  const int thread = static_cast<int>(threadIdx.x);
  mine = warp_sum(mine);
  __syncthreads();  // all threads have read the sums of the previous call
  if (thread % 32 == 0) of_warp[thread / 32] = mine;
  __syncthreads();
  Sum total = of_warp[0];
  for (int warp = 1; warp < threads / 32; ++warp) total += of_warp[warp];
  return total;
}

}  // namespace tetwarp

/// @file grouped_scan.cuh
/// Exclusive sums of counts in one launch: every block sums its group, and the block that ends last
/// sums the groups.
#pragma once
#include <cstdint>

#include "kernels/base/grouped_sums.hpp"
#include "kernels/exec/each_kernel.cuh"

namespace tetwarp {

/// The value as other blocks wrote it: not from the multiprocessor's own cache.
__device__ __forceinline__ std::int64_t read_shared_by_blocks(const std::int64_t* value) {
  return *static_cast<const volatile std::int64_t*>(value);
}

/// The sum of the values of all threads before this one.
/// @param of_warp  scratch in shared memory, shape [sum_group / 32]
/// @param total    out, the sum of all values
/// @pre all sum_group threads of the block call it
__device__ __forceinline__ std::int64_t sum_before(std::int64_t mine,
                                                   std::int64_t* of_warp,
                                                   std::int64_t& total) {
  const int thread = static_cast<int>(threadIdx.x), lane = thread % 32, warp = thread / 32;
  std::int64_t sum = mine;
  for (int step = 1; step < 32; step *= 2) {
    const std::int64_t other = __shfl_up_sync(~0u, sum, static_cast<unsigned>(step));
    if (lane >= step) sum += other;
  }
  __syncthreads();  // all threads have read the sums of the previous call
  if (lane == 31) of_warp[warp] = sum;
  __syncthreads();
  std::int64_t before = sum - mine;
  total = 0;
  for (int w = 0; w < sum_group / 32; ++w) {
    if (w < warp) before += of_warp[w];
    total += of_warp[w];
  }
  return before;
}

/// Sums body(i) for i in [0, count), then calls body.finish(total, k) for k in [0, sum_group).
///
/// Blocks: group_count(count). Threads: sum_group. No block waits for another.
/// @param ticket  zero; number of blocks that have ended, zero again afterwards
template <class Body>
__global__ void __launch_bounds__(sum_group, resident_blocks<Body>)
    grouped_scan_kernel(std::int64_t count, Body body, GroupedSums sums, unsigned* ticket) {
  __shared__ std::int64_t of_warp[sum_group / 32];
  __shared__ bool is_last;
  const int thread = static_cast<int>(threadIdx.x);
  const std::int64_t i = std::int64_t{blockIdx.x} * sum_group + thread;
  std::int64_t total = 0;
  const std::int64_t before = sum_before(i < count ? body(i) : 0, of_warp, total);
  if (i <= count) sums.within[i] = before;
  __threadfence();  // what the block wrote is visible before its ticket
  __syncthreads();
  if (thread == 0) {
    sums.groups[static_cast<std::int64_t>(blockIdx.x)] = total;
    __threadfence();
    is_last = atomicAdd(ticket, 1u) + 1 == gridDim.x;
  }
  __syncthreads();
  if (!is_last) return;
  __threadfence();
  const std::int64_t groups = std::int64_t{gridDim.x};
  std::int64_t all = 0;
  for (std::int64_t first = 0; first < groups; first += sum_group) {
    const std::int64_t g = first + thread;
    const std::int64_t own = g < groups ? read_shared_by_blocks(&sums.groups[g]) : 0;
    const std::int64_t sum = sum_before(own, of_warp, total);
    if (g < groups) sums.groups[g] = all + sum;
    all += total;
  }
  if (thread == 0) {
    sums.groups[groups] = all;
    *ticket = 0;
  }
  body.finish(all, thread);
}

}  // namespace tetwarp

/// @file grouped_scan.cuh
/// Exclusive sums of counts in one launch: every block sums its group, and the block that ends last
/// sums the groups.
#pragma once
#include <cstdint>

#include "kernels/base/grouped_sums.hpp"
#include "kernels/exec/each_kernel.cuh"
#include "kernels/exec/four_lanes.cuh"

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

/// Replaces the sums of the groups by the sums of those before each, and stores their total after
/// the last. Each thread takes successive groups. Called by all threads of one block.
/// @param of_warp  scratch, as in sum_before()
/// @returns the total
__device__ __forceinline__ std::int64_t sum_groups(std::int64_t* groups,
                                                   std::int64_t count,
                                                   std::int64_t* of_warp) {
  const int thread = static_cast<int>(threadIdx.x);
  const std::int64_t each = (count + sum_group - 1) / sum_group;
  const std::int64_t first = thread * each, past = min_of(first + each, count);
  std::int64_t own = 0, total = 0;
  for (std::int64_t g = first; g < past; ++g) own += read_shared_by_blocks(&groups[g]);
  std::int64_t before = sum_before(own, of_warp, total);
  for (std::int64_t g = first; g < past; ++g) {
    const std::int64_t sum = read_shared_by_blocks(&groups[g]);
    groups[g] = before;
    before += sum;
  }
  if (thread == 0) groups[count] = total;
  return total;
}

/// Sums op(i) for i in [0, count), then calls op.finish(total, k) for k in [0, sum_group). An
/// op with a constant `lanes` is called by four lanes as op(i, FourLanes).
///
/// Blocks: one per group. Threads: sum_group. No block waits for another.
/// @param sums    of sum_group / lanes counts per group
/// @param ticket  zero; number of blocks that have ended, zero again afterwards
template <class Op>
__global__ void __launch_bounds__(sum_group, resident_blocks<Op>)
    grouped_scan_kernel(std::int64_t count, Op op, GroupedSums sums, unsigned* ticket) {
  constexpr int lanes = lanes_of<Op>;
  __shared__ std::int64_t of_warp[sum_group / 32];
  __shared__ bool is_last;
  const int thread = static_cast<int>(threadIdx.x);
  const std::int64_t i = std::int64_t{blockIdx.x} * (sum_group / lanes) + thread / lanes;
  std::int64_t mine = 0;
  if constexpr (lanes == 1) {
    if (i < count) mine = op(i);
  } else {
    const FourLanes four = four_lanes();
    const std::int64_t value = i < count ? op(i, four) : 0;
    if (four.lane == 0) mine = value;
  }
  std::int64_t total = 0;
  const std::int64_t before = sum_before(mine, of_warp, total);
  if (i <= count && thread % lanes == 0) sums.within[i] = before;
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
  total = sum_groups(sums.groups.data, std::int64_t{gridDim.x}, of_warp);
  if (thread == 0) *ticket = 0;
  op.finish(total, thread);
}

}  // namespace tetwarp

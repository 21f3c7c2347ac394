/// @file each_kernel.cuh
/// The kernels of CudaExec::for_each() and for_each_item(), with one index per thread, and of
/// for_each_by_lanes().
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/exec/block_sum.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr int each_threads = 256;  ///< threads per block, at most

/// Blocks and their threads.
struct EachShape {
  unsigned blocks, threads;
};

/// The largest blocks of which there are at least as many as multiprocessors, or the smallest
/// blocks: a few hundred indices with long bodies are then shared by many multiprocessors.
/// @param count            threads that are needed, at least 1
/// @param multiprocessors  of the device
inline EachShape each_shape(std::int64_t count, std::int64_t multiprocessors) {
  std::int64_t threads = each_threads;
  const auto blocks = [&] { return (count + threads - 1) / threads; };
  while (threads > 32 && blocks() < multiprocessors) threads /= 2;
  return {static_cast<unsigned>(blocks()), static_cast<unsigned>(threads)};
}

/// Minimum blocks per multiprocessor, which bounds registers per thread: Op::resident_blocks
/// where the default of ptxas spills registers, else 0 for that default.
template <class Op>
constexpr int resident_blocks = [] {
  if constexpr (requires { Op::resident_blocks; }) return Op::resident_blocks;
  return 0;
}();

template <class Op>
__global__ void __launch_bounds__(each_threads, resident_blocks<Op>)
    each_kernel(std::int64_t count, Op op) {
  const std::int64_t i = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  if (i < count) op(i);
}

/// Op::lanes lanes per index: calls op.finish(i, sum of op.part(i, lane) over the lanes).
template <class Op>
__global__ void __launch_bounds__(each_threads) each_by_lanes_kernel(std::int64_t count, Op op) {
  const std::int64_t thread = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  const std::int64_t i = thread / Op::lanes;
  const int lane = static_cast<int>(threadIdx.x) % Op::lanes;
  if ((thread - threadIdx.x % 32) / Op::lanes >= count) return;  // all lanes of the warp
  typename Op::Sum mine{};
  if (i < count) mine = op.part(i, lane);
  mine = warp_sum<Op::lanes>(mine);
  if (i < count && lane == 0) op.finish(i, mine);
}

/// One index = one run of one entry.
template <class Op>
struct SingleRuns {
  Op op;

  TETWARP_HD auto operator()(std::int64_t i) const { return op.template run<1>(i, i + 1); }
};

/// One index = one byte.
struct ZeroOp {
  View<std::uint8_t> bytes;

  TETWARP_HD void operator()(std::int64_t i) const { bytes[i] = 0; }
};

/// The last index in [0, size - 1) whose offset is not above `item`, for the item of each lane:
/// those of a warp are successive. The lanes first search for the first item together, so that few
/// loads wait for others.
/// @pre offsets[0] <= item < offsets[size - 1]; all lanes of the warp call it
template <class Offsets>
__device__ __forceinline__ std::int64_t segment_of(const Offsets& offsets, std::int64_t item) {
  const int lane = static_cast<int>(threadIdx.x) % 32;
  const std::int64_t first = __shfl_sync(~0u, item, 0);
  std::int64_t low = 0, high = offsets.size - 1;
  while (low + 1 < high) {
    const std::int64_t step = (high - low + 31) / 32, probe = low + step * (lane + 1);
    const bool is_before = probe < high && offsets[min_of(probe, high)] <= first;
    low += step * __popc(__ballot_sync(~0u, is_before));
    high = min_of(low + step, high);
  }
  const std::int64_t last = offsets.size - 2;
  std::int64_t found = low;
  for (bool is_open = true;; low += 31) {
    const std::int64_t start = offsets[min_of(low + lane, last)];
    int before = 0;  // of the 32 segments from low on, the last that begins at or before the item
    for (int step = 16; step > 0; step /= 2) {
      const std::int64_t other = __shfl_sync(~0u, start, before + step);
      if (other <= item) before += step;
    }
    if (is_open) found = min_of(low + before, last);
    is_open = is_open && before == 31 && low + 31 < last;
    if (!__any_sync(~0u, is_open)) return found;
  }
}

/// Calls op(segment, index in the segment, item).
/// @tparam Offsets  View<const std::int64_t> or GroupedSums
template <class Offsets, class Op>
__global__ void __launch_bounds__(each_threads, resident_blocks<Op>)
    each_item_kernel(Offsets offsets, std::int64_t capacity, Op op) {
  const std::int64_t item = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x;
  const std::int64_t count = min_of(offsets[offsets.size - 1], capacity);
  if (item - threadIdx.x % 32 >= count) return;  // all lanes of the warp
  const std::int64_t segment = segment_of(offsets, min_of(item, count - 1));
  if (item < count) op(segment, item - offsets[segment], item);
}

}  // namespace tetwarp

/// @file each_kernel.cuh
/// The kernels of CudaExec::for_each() and for_each_item(): one index per thread.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr int each_threads = 256;  ///< threads per block

/// Minimum blocks per multiprocessor, which bounds registers per thread: Body::resident_blocks
/// where the default of ptxas spills registers, else 0 for that default.
template <class Body>
constexpr int resident_blocks = [] {
  if constexpr (requires { Body::resident_blocks; }) return Body::resident_blocks;
  return 0;
}();

template <class Body>
__global__ void __launch_bounds__(each_threads, resident_blocks<Body>)
    each_kernel(std::int64_t count, Body body) {
  const std::int64_t i = std::int64_t{blockIdx.x} * each_threads + threadIdx.x;
  if (i < count) body(i);
}

/// One index = one byte.
struct ZeroBody {
  View<std::uint8_t> bytes;

  TETWARP_HD void operator()(std::int64_t i) const { bytes[i] = 0; }
};

/// Calls body(segment, index in the segment, item), the segment found by bisection of `offsets`.
/// @tparam Offsets  View<const std::int64_t> or GroupedSums
template <class Offsets, class Body>
__global__ void __launch_bounds__(each_threads, resident_blocks<Body>)
    each_item_kernel(Offsets offsets, std::int64_t capacity, Body body) {
  const std::int64_t item = std::int64_t{blockIdx.x} * each_threads + threadIdx.x;
  std::int64_t low = 0, high = offsets.size - 1;
  if (item >= min_of(offsets[high], capacity)) return;
  while (low + 1 < high) {
    const std::int64_t middle = (low + high) / 2;
    if (offsets[middle] <= item) {
      low = middle;
    } else {
      high = middle;
    }
  }
  body(low, item - offsets[low], item);
}

}  // namespace tetwarp

/// @file island_block.cuh
/// Conjugate gradients of small islands: one block of a device does all iterations of an island in
/// a single launch. The order of sums differs from that of the host.
#pragma once
#include <cstdint>

#include "kernels/body/island_cg.hpp"
#include "kernels/exec/block_sum.cuh"

namespace tetwarp {

/// The executor of island_cg() within one block. Every thread makes every call.
class BlockGradientExec {
 public:
  /// @param shared  scratch for block_sum(), [sum_warps]
  __device__ explicit BlockGradientExec(PlainSums<2>* shared) : shared_(shared) {}

  template <class Body>
  __device__ __forceinline__ void for_each(std::int64_t begin,
                                           std::int64_t end,
                                           const Body& body) const {
    for (std::int64_t i = begin + thread(); i < end; i += sum_threads) body(i);
    __syncthreads();
  }
  template <class Body>
  __device__ __forceinline__ void once(const Body& body) const {
    if (threadIdx.x == 0) body(0);
    __syncthreads();
  }
  template <class Body, int count>
  __device__ __forceinline__ void sum_to(std::int64_t begin,
                                         std::int64_t end,
                                         const Body& body,
                                         PlainSums<count>* out) const {
    PlainSums<count> mine{};
    for (std::int64_t i = begin + thread(); i < end; i += sum_threads) mine += body(i);
    const PlainSums<count> total = block_sum(mine, reinterpret_cast<PlainSums<count>*>(shared_));
    if (threadIdx.x == 0) *out = total;
    __syncthreads();
  }
  template <class Value>
  __device__ __forceinline__ Value load(const Value* value) const {
    const Value copy = *value;
    __syncthreads();  // before thread 0 writes the next value
    return copy;
  }
  __device__ std::int64_t iterations_at_once() const { return 1; }
  template <class Iteration>
  __device__ __forceinline__ void repeat(std::int64_t, const Iteration& iteration) const {
    iteration.run(*this);
  }

 private:
  __device__ static std::int64_t thread() { return static_cast<std::int64_t>(threadIdx.x); }

  PlainSums<2>* shared_;
};

/// Rows [begin, end) of an island.
struct IslandRows {
  std::int64_t begin, end;
};

struct AlwaysProceed {
  __device__ bool operator()(std::int64_t) const { return true; }
};

/// Bytes of shared memory of a block.
constexpr std::size_t island_shared_bytes =
    sizeof(GradientScalars) + sum_warps * sizeof(PlainSums<2>);

/// Blocks: one per island. Threads: sum_threads. Shared: island_shared_bytes. Registers: up to 128.
template <class T>
__global__ void __launch_bounds__(sum_threads, 4) island_cg_kernel(GradientArrays<T> arrays,
                                                                   View<const IslandRows> islands,
                                                                   GradientOptions options,
                                                                   View<GradientEnd> ends) {
  unsigned char* const shared = dynamic_shared<unsigned char>();
  auto* const scalars = reinterpret_cast<GradientScalars*>(shared);
  BlockGradientExec exec(reinterpret_cast<PlainSums<2>*>(shared + sizeof(GradientScalars)));
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  const IslandRows rows = islands[which];
  const GradientEnd end =
      island_cg(exec, arrays, rows.begin, rows.end, options, scalars, AlwaysProceed{});
  if (threadIdx.x == 0) ends[which] = end;
}

}  // namespace tetwarp

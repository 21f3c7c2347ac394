/// @file island_block.cuh
/// Conjugate gradients of small islands: one block of a device does all iterations of an island in
/// a single launch. The order of sums differs from that of the host.
#pragma once
#include <cstdint>

#include "kernels/body/island_cg.hpp"
#include "kernels/exec/island_exec.cuh"

namespace tetwarp {

/// Rows [begin, end) of an island.
struct IslandRows {
  std::int64_t begin, end;
};

struct AlwaysProceed {
  __device__ bool operator()(std::int64_t) const { return true; }
};

/// Blocks: one per island. Threads: sum_threads. Shared: IslandExec<BlockTeam>::shared_bytes.
/// Registers: up to 128.
template <class T>
__global__ void __launch_bounds__(sum_threads, 4) island_cg_kernel(GradientArrays<T> arrays,
                                                                   View<const IslandRows> islands,
                                                                   GradientOptions options,
                                                                   View<GradientEnd> ends) {
  IslandExec<BlockTeam> exec(dynamic_shared<unsigned char>());
  auto* const scalars = exec.template state<GradientScalars>();
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  const IslandRows rows = islands[which];
  const GradientEnd end =
      island_cg(exec, arrays, rows.begin, rows.end, options, scalars, AlwaysProceed{});
  if (threadIdx.x == 0) ends[which] = end;
}

}  // namespace tetwarp

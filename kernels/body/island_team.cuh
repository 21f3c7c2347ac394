/// @file island_team.cuh
/// Conjugate gradients of an island in a single launch: by one block, or by a grid that
/// synchronizes itself. The order of sums differs from that of the host.
#pragma once
#include <cstddef>
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

/// Every thread of a team has all sums and computes the scalars for itself, which saves barriers:
/// an iteration has those of two sums, and one.
template <class Team, class Op, class Sum>
__device__ __forceinline__ void gradient_sum(IslandExec<Team>& exec,
                                             const char* label,
                                             std::int64_t begin,
                                             std::int64_t end,
                                             const Op& op,
                                             Sum* out) {
  *out = exec.template sum<Sum>(label, begin, end, op);
}
template <class Team, class Op>
__device__ __forceinline__ void gradient_once(IslandExec<Team>&, const char*, const Op& op) {
  op(0);
}

/// Blocks: one per island. Threads: `threads`. Shared: TeamOfBlock<threads>::shared_bytes, dynamic.
/// Registers: up to 128.
template <class T, int threads>
__global__ void __launch_bounds__(threads, 512 / threads)
    island_cg_kernel(GradientArrays<T> arrays,
                     View<const IslandRows> islands,
                     GradientOptions options,
                     View<GradientEnd> ends) {
  using Team = TeamOfBlock<threads>;
  IslandExec<Team> exec(nullptr, Team(dynamic_shared<unsigned char>()));
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  const IslandRows rows = islands[which];
  IslandScalars scalars;
  const GradientEnd end =
      island_cg(exec, arrays, rows.begin, rows.end, options, &scalars, AlwaysProceed{});
  if (threadIdx.x == 0) ends[which] = end;
}

/// Blocks: as many as are resident together, at most. Threads: sum_threads. Shared:
/// GridTeam::shared_bytes, dynamic. Registers: up to 255.
/// @param sums  [GridTeam::sum_bytes(rows of the island)]
/// @param end   out, [1]
template <class T>
__global__ void __launch_bounds__(sum_threads, 2) island_cg_grid_kernel(GradientArrays<T> arrays,
                                                                        IslandRows rows,
                                                                        GradientOptions options,
                                                                        void* sums,
                                                                        View<GradientEnd> end) {
  IslandExec<GridTeam> exec(nullptr,
                            GridTeam(sums, rows.end - rows.begin, dynamic_shared<unsigned char>()));
  IslandScalars scalars;
  const GradientEnd own =
      island_cg(exec, arrays, rows.begin, rows.end, options, &scalars, AlwaysProceed{});
  if (exec.first() == 0) end[0] = own;
}

}  // namespace tetwarp

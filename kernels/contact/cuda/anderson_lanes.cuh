/// @file anderson_lanes.cuh
/// AndersonState::decide() by the lanes of one warp, with the same operations on every number.
#pragma once
#include "kernels/contact/anderson.hpp"
#include "kernels/exec/island_exec.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// Lane i factorizes row i of the least squares problem; each lane has the whole solution.
/// @param state  in shared memory
/// @pre all lanes of the warp call it
__device__ __forceinline__ void decide_by_lanes(AndersonState& state, int lane) {
  constexpr int window = AndersonState::window;
  int depth = 0;
  if (lane == 0 && state.take_sums()) depth = state.depth;
  __syncwarp();
  depth = __shfl_sync(~0u, depth, 0);
  if (depth == 0) {
    if (lane == 0) state.finish();
    return;
  }
  const int i = lane < depth ? lane : 0;  // other lanes repeat the first row
  const double scale = state.scale_of(i);
  double row[window], x[window];
  for (int j = 0; j < window; ++j) {
    const double other = __shfl_sync(~0u, scale, j);
    row[j] = j < depth ? state.scaled(i, j, scale, other) : 0.0;
  }
  const double right = scale * state.sums.value[window + i];
  bool is_positive = true;
  for (int j = 0; j < window; ++j) {
    x[j] = __shfl_sync(~0u, right, j);
    double sum = row[j];
    for (int k = 0; k < j; ++k) {
      const double pivot_row = __shfl_sync(~0u, row[k], j);
      sum -= row[k] * pivot_row;
      x[j] -= pivot_row * x[k];
    }
    const double pivot = __shfl_sync(~0u, sum, j);
    if (j < depth) is_positive = is_positive && pivot > 0;
    const double root = sqrt(pivot);
    row[j] = i == j ? root : sum / root;
    x[j] /= root;
  }
  for (int j = window - 1; j >= 0; --j) {
    double sum = x[j];
    for (int k = j + 1; k < window; ++k) {
      const double below = __shfl_sync(~0u, row[j], k);
      if (k < depth) sum -= below * x[k];
    }
    x[j] = sum / __shfl_sync(~0u, row[j], j);
  }
  for (int k = 0; k < window; ++k) x[k] *= __shfl_sync(~0u, scale, k);
  if (lane == 0) {
    state.set_factors(is_positive, x);
    state.finish();
  }
}

/// As AndersonDecideOp on one thread, by the lanes of an island.
template <class Team>
__device__ __forceinline__ void anderson_decide(IslandExec<Team>& exec, AndersonState* state) {
  static_assert(sizeof(AndersonState::sums) <= sizeof(LargestSum));
  exec.once_by_lanes([&](int lane) { decide_by_lanes(*state, lane); });
}

}  // namespace tetwarp

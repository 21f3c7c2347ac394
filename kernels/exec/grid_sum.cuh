/// @file grid_sum.cuh
/// Sums over a whole device by a fixed tree: a kernel that sums runs, launched once for the terms
/// and once for their sums.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/exec/block_sum.cuh"

namespace tetwarp {

constexpr std::int64_t sum_run = sum_threads;  ///< terms per block of a sum, at least
constexpr std::int64_t most_sum_runs = 2048;   ///< one block sums these

/// Terms per block of a sum of `terms` terms: one per thread, unless there would be too many runs.
TETWARP_HD std::int64_t sum_run_of(std::int64_t terms) {
  std::int64_t run = sum_run;
  while (terms > most_sum_runs * run) run *= 2;
  return run;
}
/// Runs of a sum of `terms` terms.
TETWARP_HD std::int64_t sum_runs_of(std::int64_t terms) {
  const std::int64_t run = sum_run_of(terms);
  return (terms + run - 1) / run;
}
/// At least the runs of every sum of at most `terms` terms.
TETWARP_HD std::int64_t most_sum_runs_of(std::int64_t terms) {
  return min_of((terms + sum_run - 1) / sum_run, most_sum_runs);
}

/// sums[b] = sum of term over the b-th `run` of [first, last).
/// Blocks: one per run. Threads: sum_threads. Shared: one sum per warp. Registers: up to 128.
template <class Sum, class Term>
__global__ void __launch_bounds__(sum_threads, 4) sums_kernel(
    std::int64_t first, std::int64_t last, std::int64_t run, Term term, View<Sum> sums) {
  Sum* const of_warp = dynamic_shared<Sum>();
  const std::int64_t begin = first + run * static_cast<std::int64_t>(blockIdx.x);
  const std::int64_t end = min_of(begin + run, last);
  Sum mine{};
  for (std::int64_t i = begin + static_cast<std::int64_t>(threadIdx.x); i < end; i += sum_threads) {
    mine += term(i);
  }
  const Sum total = block_sum(mine, of_warp);
  if (threadIdx.x == 0) sums[static_cast<std::int64_t>(blockIdx.x)] = total;
}

/// Terms [begin, end) of a sum.
struct SumRun {
  std::int64_t begin, end;
};

/// sums[b] = sum of term over runs[b].
/// Blocks: one per run. Threads: sum_threads. Shared: one sum per warp. Registers: up to 128.
template <class Sum, class Term>
__global__ void __launch_bounds__(sum_threads, 4)
    run_sums_kernel(View<const SumRun> runs, Term term, View<Sum> sums) {
  Sum* const of_warp = dynamic_shared<Sum>();
  const SumRun run = runs[static_cast<std::int64_t>(blockIdx.x)];
  Sum mine{};
  for (std::int64_t i = run.begin + static_cast<std::int64_t>(threadIdx.x); i < run.end;
       i += sum_threads) {
    mine += term(i);
  }
  const Sum total = block_sum(mine, of_warp);
  if (threadIdx.x == 0) sums[static_cast<std::int64_t>(blockIdx.x)] = total;
}

/// One index = one partial sum.
template <class Sum>
struct ReadySums {
  View<const Sum> sums;

  TETWARP_HD Sum operator()(std::int64_t i) const { return sums[i]; }
};

}  // namespace tetwarp

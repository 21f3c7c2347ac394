/// @file grid_island.cuh
/// Solves a large island in one launch: the threads of all resident blocks share the indices of a
/// stage and synchronize the whole grid after it; all decisions are made on the device.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "kernels/contact/cuda/contact_block.cuh"
#include "kernels/exec/device_limits.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/island_exec.cuh"

namespace tetwarp {

using GridExec = IslandExec<GridTeam>;

/// One island that is solved by a whole grid.
template <class T>
struct GridIslandJob {
  ContactNumbers<T> numbers;
  ContactState<T> state;  ///< impulse in: to start from; out: the best found
  MethodWork<T> work;
  View<const std::int64_t> color_start;  ///< in memory of the device
  ContactSwitches switches;
  MethodPlan plan;
  IslandTask task;
  void* method_state;  ///< [GridExec::state_bytes]
  void* sums;          ///< [GridTeam::sum_bytes(most_terms)]
  std::int64_t most_terms;
  View<IslandResult> result;  ///< out, [1]
  View<ContactEvent> events;  ///< out
};

/// Blocks: as many as are resident together, at most. Threads: island_threads. Shared:
/// GridTeam::shared_bytes, dynamic. Registers: up to 255.
template <class T>
__global__ void __launch_bounds__(island_threads, island_blocks)
    contact_grid_kernel(GridIslandJob<T> job) {
  GridExec exec(job.method_state,
                GridTeam(job.sums, job.most_terms, dynamic_shared<unsigned char>()));
  ContactPipeline<GridExec, T> pipeline(exec, job.numbers, job.color_start, job.task.island,
                                        job.switches, job.state);
  ThinnedEventLog log(job.events, GridExec::first() == 0);
  IslandResult result;
  result.end = solve_island(pipeline, job.task.criterion, job.plan, 0, job.work, log);
  result.events = log.end();
  if (GridExec::first() == 0) job.result[0] = result;
}

/// Times of a sweep, estimated. Stages besides those of colors mix and measure. A stage of a block
/// waits for memory, mostly shared; one of a grid also synchronizes it. What does not fit shared
/// memory passes each multiprocessor at 50 GB/s, since few threads wait for few numbers each.
/// @param bytes  of the arrays of the island
inline TeamTimes sweep_times(const ContactIsland& island, std::int64_t bytes) {
  constexpr double other_stages = 8, rate = 50e9, of_acceleration = 550;
  const auto contacts = static_cast<double>(island.contact_count());
  const auto colors = static_cast<double>(island.color_end - island.color_begin - 1);
  const double stages = other_stages + colors;
  const double passing = (static_cast<double>(bytes) + of_acceleration * contacts) / rate;
  const double warps = std::clamp(contacts / (32 * colors), 1.0, 64.0);  // that a color occupies
  return {1.6e-6 * stages + passing, 3e-6 * stages + passing / warps};
}

/// The largest number of terms that the solve of an island sums.
inline std::int64_t most_terms_of(const ContactIsland& island) {
  return std::max(3 * island.contact_count(), island.block_count());
}

/// Solves an island by one launch on the whole device.
/// @param multiprocessors  of the device, which can synchronize a grid; one block each at most:
///                         more blocks synchronize more slowly
///
/// Determinism: the bits of the same solve stage by stage with CudaExec, for any number of
/// blocks. Cost: per stage one synchronization of the grid, besides what the stages cost.
template <class T>
void contact_solve_by_grid(cudaStream_t stream,
                           const GridIslandJob<T>& job,
                           std::int64_t multiprocessors) {
  int resident = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&resident, contact_grid_kernel<T>,
                                                           island_threads, GridTeam::shared_bytes),
             "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  const std::int64_t wanted = 1 + most_terms_of(job.task.island) / island_threads;
  const std::int64_t most = std::max<std::int64_t>(multiprocessors, wanted / 4);
  const std::int64_t blocks =
      std::min({wanted, most, static_cast<std::int64_t>(resident) * multiprocessors});
  launch_cooperative(stream, contact_grid_kernel<T>, dim3(static_cast<unsigned>(blocks)),
                     dim3(island_threads), GridTeam::shared_bytes, job);
}

}  // namespace tetwarp

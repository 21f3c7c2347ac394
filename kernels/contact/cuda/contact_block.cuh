/// @file contact_block.cuh
/// Solves an island with one block of a device, or with one of its warps: all sweeps, measurements
/// and the acceleration in a single launch.
///
/// The threads share the indices of a stage; a barrier ends each stage. Impulses, velocities and
/// constants are in shared memory as far as they fit, else in global memory. The order of updates
/// is that of the host; sums have another tree, the same for blocks and warps.
#pragma once
#include <algorithm>
#include <cstdint>

#include "kernels/contact/contact_methods.hpp"
#include "kernels/contact/cuda/anderson_lanes.cuh"
#include "kernels/contact/cuda/delassus_lanes.cuh"
#include "kernels/contact/cuda/island_cache.cuh"
#include "kernels/contact/cuda/thinned_event_log.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/island_exec.cuh"

namespace tetwarp {

constexpr int island_threads = sum_threads;
constexpr int island_blocks = 2;            ///< resident per multiprocessor: 255 registers
constexpr std::int64_t warp_contacts = 32;  ///< larger islands use a block

/// An island to solve, and its stop criterion.
struct IslandTask {
  ContactIsland island;
  StopCriterion criterion;
  IslandArrays arrays = {};
};

/// How its solve ended.
struct IslandResult {
  IslandEnd end;
  std::int64_t events = 0;  ///< residuals kept in the log
};

/// Islands that are solved by one block each, or by one warp each.
template <class T>
struct IslandJob {
  ContactNumbers<T> numbers;
  ContactState<T> state;  ///< impulse in: to start from; out: the best found
  MethodWork<T> work;
  View<const std::int64_t> color_start;
  ContactSwitches switches;
  MethodPlan plan;
  View<const IslandTask> tasks;
  std::int64_t shared_bytes;   ///< for copies of the arrays of an island
  View<IslandResult> results;  ///< out, [tasks]
  View<ContactEvent> events;   ///< out, [tasks][events_per_island]
  std::int64_t events_per_island;
};

/// Blocks: one for island_threads / threads islands. Threads: island_threads. Shared: for each
/// island IslandExec::shared_bytes and job.shared_bytes, dynamic. Registers: up to 255.
/// @tparam threads  that solve an island: island_threads or 32
template <class T, int threads>
__global__ void __launch_bounds__(island_threads, island_blocks)
    contact_island_kernel(IslandJob<T> job) {
  using Exec = ThreadsExec<threads>;
  constexpr int islands = island_threads / threads;
  const int own = static_cast<int>(threadIdx.x) / threads;
  const std::int64_t which = std::int64_t{blockIdx.x} * islands + own;
  if (which >= job.tasks.size) return;  // a whole warp
  unsigned char* const shared =
      dynamic_shared<unsigned char>() +
      own * (static_cast<std::int64_t>(Exec::shared_bytes) + job.shared_bytes);
  const IslandTask& task = job.tasks[which];
  const ContactIsland& island = task.island;
  Exec exec(shared);
  ContactNumbers<T> numbers = job.numbers;
  ContactState<T> state = job.state;
  IslandCache<Exec>(exec, shared + Exec::shared_bytes, job.shared_bytes)
      .take(island, task.arrays, numbers, state);
  ContactPipeline<Exec, T> pipeline(exec, numbers, job.color_start, island, job.switches, state);
  ThinnedEventLog log({job.events.data + which * job.events_per_island, job.events_per_island},
                      Exec::first() == 0);
  IslandResult result;
  result.end = solve_island(pipeline, task.criterion, job.plan, 0, job.work, log);
  result.events = log.end();
  const auto put_back = [&](View<T> from, T* to) {
    if (from.data != to) exec.copy("contact/sweep", View<const T>(from), View<T>{to, from.size});
  };
  put_back(pipeline.impulse(), job.state.impulse.data + 3 * island.slot_begin);
  put_back(pipeline.body_velocity(), job.state.body_velocity.data + island.dof_begin);
  if (Exec::first() == 0) job.results[which] = result;
}

/// Shared memory that a block has without a request for more [bytes].
constexpr std::int64_t common_shared_bytes = std::int64_t{48} * 1024;

/// Shared memory for the arrays of each island: enough for the largest island, or all that a block
/// may have.
/// @param tasks     in memory of the host
/// @param most      shared memory that a block may have [bytes]
template <class T, int threads>
std::int64_t shared_bytes_for(View<const IslandTask> tasks, bool is_local, std::int64_t most) {
  constexpr std::int64_t islands = island_threads / threads;
  const std::int64_t room =
      (most / islands - static_cast<std::int64_t>(ThreadsExec<threads>::shared_bytes)) / 16 * 16;
  std::int64_t largest = 0;
  for (std::int64_t i = 0; i < tasks.size; ++i) {
    largest = std::max(largest, island_bytes<T>(tasks[i].island, tasks[i].arrays, is_local));
  }
  return std::min(largest, room);
}

/// Solves every island of the job.
/// @param stream  where to run
/// @pre  at least one task
///
/// Determinism: same bits in every run and for any number of threads per island, because islands
/// share no data, contacts of one color share none, and sums are fixed trees. Cost: one barrier per
/// stage, besides the stages.
template <class T, int threads = island_threads>
void contact_solve_islands(cudaStream_t stream, const IslandJob<T>& job) {
  constexpr std::int64_t islands = island_threads / threads;
  const std::int64_t bytes =
      islands * (static_cast<std::int64_t>(ThreadsExec<threads>::shared_bytes) + job.shared_bytes);
  if (bytes > common_shared_bytes) {
    check_cuda(
        cudaFuncSetAttribute(reinterpret_cast<const void*>(&contact_island_kernel<T, threads>),
                             cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(bytes)),
        "cudaFuncSetAttribute");
  }
  launch(stream, contact_island_kernel<T, threads>,
         dim3(static_cast<unsigned>((job.tasks.size + islands - 1) / islands)),
         dim3(island_threads), static_cast<std::size_t>(bytes), job);
}

/// Islands to measure.
template <class T>
struct MeasureJob {
  ContactNumbers<T> numbers;
  ContactState<T> state;  ///< out: its velocities become those of the impulses
  View<const std::int64_t> color_start;
  ContactSwitches switches;
  View<const ContactIsland> islands;
  View<IslandSums> sums;  ///< out, [islands]
};

/// Blocks: one per island. Threads: island_threads. Shared:
/// IslandExec<BlockTeam>::shared_bytes, dynamic. Registers: up to 128.
template <class T>
__global__ void __launch_bounds__(island_threads, 4) contact_measure_kernel(MeasureJob<T> job) {
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  IslandExec<BlockTeam> exec(dynamic_shared<unsigned char>());
  const IslandSums sums = measure_island(ContactPipeline<IslandExec<BlockTeam>, T>(
      exec, job.numbers, job.color_start, job.islands[which], job.switches, job.state));
  if (threadIdx.x == 0) job.sums[which] = sums;
}

/// Measures every island of the job.
/// @pre  at least one island
///
/// Determinism: same bits in every run; sums are fixed trees.
template <class T>
void contact_measure_islands(cudaStream_t stream, const MeasureJob<T>& job) {
  launch(stream, contact_measure_kernel<T>, dim3(static_cast<unsigned>(job.islands.size)),
         dim3(island_threads), IslandExec<BlockTeam>::shared_bytes, job);
}

}  // namespace tetwarp

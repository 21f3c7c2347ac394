/// @file contact_block.cuh
/// Solves an island with one block of a device: all sweeps, measurements and the acceleration in a
/// single launch.
///
/// 128 threads share the indices of a stage; a barrier ends each stage. Impulses and body
/// velocities are in shared memory if they fit, else in global memory. The order of updates is that
/// of the host; sums have another tree.
#pragma once
#include <algorithm>
#include <cstdint>

#include "kernels/contact/contact_methods.hpp"
#include "kernels/exec/block_sum.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

constexpr int island_threads = sum_threads;
constexpr int island_blocks = 2;               ///< resident per multiprocessor: 255 registers
constexpr std::int64_t block_contacts = 2048;  ///< larger islands use the whole device

/// The executor of the contact pipeline within one block. Every thread makes every call and
/// receives the same results.
class BlockContactExec {
 public:
  using LargestSum = PlainSums<2 * anderson_window + 1>;
  static constexpr std::size_t state_bytes = 1024;
  static constexpr std::size_t shared_bytes = state_bytes + sum_warps * sizeof(LargestSum);

  /// @param shared  [shared_bytes]
  __device__ explicit BlockContactExec(void* shared) : shared_(shared) {}

  template <class Body>
  __device__ __forceinline__ void for_each(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += island_threads) body(i);
    __syncthreads();
  }
  template <class Body>
  __device__ __forceinline__ void for_runs(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += island_threads) body.template run<1>(i, i + 1);
    __syncthreads();
  }
  template <class Body>
  __device__ __forceinline__ void once(const char*, const Body& body) const {
    if (threadIdx.x == 0) body(0);
    __syncthreads();
  }

  /// Default-constructs a State in shared memory; replaces that of the previous call.
  template <class State>
  __device__ __forceinline__ State* state() const {
    static_assert(sizeof(State) <= state_bytes && alignof(State) <= 16);
    State* const state = static_cast<State*>(shared_);
    if (threadIdx.x == 0) *state = State{};
    __syncthreads();
    return state;
  }
  template <class T>
  __device__ __forceinline__ T load(const T* value) const {
    return *value;
  }
  template <class T>
  __device__ __forceinline__ T load_without_sync(const T* value, T) const {
    return *value;
  }
  __device__ __forceinline__ bool is_sync_point(std::int64_t) const { return true; }

  template <class T>
  __device__ __forceinline__ void copy(const char*, View<const T> from, View<T> to) const {
    for (std::int64_t i = first(); i < from.size; i += island_threads) to[i] = from[i];
    __syncthreads();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ Sum
  sum(const char*, std::int64_t begin, std::int64_t end, const Body& body) const {
    static_assert(sizeof(Sum) <= sizeof(LargestSum));
    Sum mine{};
    for (std::int64_t i = begin + first(); i < end; i += island_threads) mine += body(i);
    return block_sum(mine, sums<Sum>());
  }
  template <class Sum, class Body>
  __device__ __forceinline__ Sum
  sum_runs(const char*, std::int64_t begin, std::int64_t end, const Body& body) const {
    static_assert(sizeof(Sum) <= sizeof(LargestSum));
    Sum mine{};
    for (std::int64_t i = begin + first(); i < end; i += island_threads) {
      mine += body.template run<1>(i, i + 1);
    }
    return block_sum(mine, sums<Sum>());
  }

  template <class Sum, class Body>
  __device__ __forceinline__ void sum_to(
      const char* stage, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) const {
    const Sum total = sum<Sum>(stage, begin, end, body);
    if (threadIdx.x == 0) *out = total;
    __syncthreads();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ void sum_runs_to(
      const char* stage, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) const {
    const Sum total = sum_runs<Sum>(stage, begin, end, body);
    if (threadIdx.x == 0) *out = total;
    __syncthreads();
  }

 private:
  template <class Sum>
  __device__ Sum* sums() const {
    return reinterpret_cast<Sum*>(static_cast<unsigned char*>(shared_) + state_bytes);
  }
  __device__ static std::int64_t first() { return static_cast<std::int64_t>(threadIdx.x); }

  void* shared_;
};

/// Stores the last measured residual and an evenly spaced selection of those before it. One thread
/// writes.
class ThinnedEventLog {
 public:
  /// @param events  room for two or more
  /// @param writes  whether this thread is the one that writes
  __device__ ThinnedEventLog(View<ContactEvent> events, bool writes)
      : events_(events), writes_(writes) {}

  __device__ void note(const ContactEvent& event) {
    last_ = event;
    is_last_kept_ = seen_++ % stride_ == 0;
    if (!is_last_kept_) return;
    if (count_ == events_.size) {
      for (std::int64_t k = 1; 2 * k < count_ && writes_; ++k) events_[k] = events_[2 * k];
      count_ = (count_ + 1) / 2;
      stride_ *= 2;
      is_last_kept_ = (seen_ - 1) % stride_ == 0;
      if (!is_last_kept_) return;
    }
    if (writes_) events_[count_] = event;
    ++count_;
  }
  /// A solve within one launch is not interrupted.
  __device__ bool stops() const { return false; }
  /// @return  how many residuals are kept
  __device__ std::int64_t end() {
    if (seen_ > 0 && !is_last_kept_) {
      count_ = min_of(count_ + 1, events_.size);
      if (writes_) events_[count_ - 1] = last_;
    }
    return count_;
  }

 private:
  View<ContactEvent> events_;
  bool writes_;
  std::int64_t count_ = 0, stride_ = 1, seen_ = 0;
  ContactEvent last_ = {};
  bool is_last_kept_ = true;
};

/// An island to solve, and its stop criterion.
struct IslandTask {
  ContactIsland island;
  StopCriterion criterion;
};

/// How its solve ended.
struct IslandResult {
  IslandEnd end;
  std::int64_t events = 0;  ///< residuals kept in the log
};

/// All islands that are solved by one block each.
template <class T>
struct IslandJob {
  ContactNumbers<T> numbers;
  ContactState<T> state;  ///< impulse in: to start from; out: the best found
  MethodWork<T> work;
  View<const std::int64_t> color_start;
  ContactSwitches switches;
  MethodPlan plan;
  View<const IslandTask> tasks;
  std::int64_t shared_values;  ///< islands with more numbers stay in global memory
  View<IslandResult> results;  ///< out, [tasks]
  View<ContactEvent> events;   ///< out, [tasks][events_per_island]
  std::int64_t events_per_island;
};

/// Moves a view so that index `first` is at `place`.
template <class T>
__device__ __forceinline__ void move_view(View<T>& view, std::int64_t first, T* place) {
  view.data = place - first;
}

/// Blocks: one per island. Threads: island_threads. Shared: BlockContactExec::shared_bytes and
/// job.shared_values numbers, dynamic. Registers: up to 255.
template <class T>
__global__ void __launch_bounds__(island_threads, island_blocks)
    contact_island_kernel(IslandJob<T> job) {
  unsigned char* const shared = dynamic_shared<unsigned char>();
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  const ContactIsland& island = job.tasks[which].island;
  BlockContactExec exec(shared);
  ContactState<T> state = job.state;
  const std::int64_t first = 3 * island.slot_begin, size = 3 * island.contact_count();
  const View<T> global = {state.impulse.data + first, size};
  const bool is_shared = island.value_count() <= job.shared_values;
  if (is_shared) {
    T* const place = reinterpret_cast<T*>(shared + BlockContactExec::shared_bytes);
    exec.copy("contact/sweep", View<const T>(global), View<T>{place, size});
    move_view(state.impulse, first, place);
    if (!job.numbers.is_local) move_view(state.body_velocity, island.dof_begin, place + size);
  }
  ContactPipeline<BlockContactExec, T> pipeline(exec, job.numbers, job.color_start, island,
                                                job.switches, state);
  ThinnedEventLog log({job.events.data + which * job.events_per_island, job.events_per_island},
                      threadIdx.x == 0);
  IslandResult result;
  result.end = solve_island(pipeline, job.tasks[which].criterion, job.plan, 0, job.work, log);
  result.events = log.end();
  if (is_shared) {
    exec.copy("contact/sweep", View<const T>(pipeline.impulse()), global);
    exec.copy("contact/sweep", View<const T>(pipeline.body_velocity()),
              View<T>{job.state.body_velocity.data + island.dof_begin,
                      island.dof_end - island.dof_begin});
  }
  if (threadIdx.x == 0) job.results[which] = result;
}

/// Number of an island's values that fit in the 48 KiB of shared memory of a block.
template <class T>
constexpr std::int64_t shared_capacity = static_cast<std::int64_t>(
    (std::size_t{48} * 1024 - BlockContactExec::shared_bytes) / sizeof(T));

/// The largest number of values of the islands that fit in shared memory.
/// @param tasks  in memory of the host
template <class T>
std::int64_t shared_values_for(View<const IslandTask> tasks) {
  std::int64_t largest = 0;
  for (std::int64_t i = 0; i < tasks.size; ++i) {
    const std::int64_t count = tasks[i].island.value_count();
    if (count <= shared_capacity<T>) largest = std::max(largest, count);
  }
  return largest;
}

/// Solves every island of the job.
/// @param stream  where to run
/// @pre  at least one task
///
/// Determinism: same bits in every run; islands share no data, contacts of a color neither, sums
/// are fixed trees. Cost: per stage one barrier, besides what the stages cost.
template <class T>
void contact_solve_islands(cudaStream_t stream, const IslandJob<T>& job) {
  launch(stream, contact_island_kernel<T>, dim3(static_cast<unsigned>(job.tasks.size)),
         dim3(island_threads),
         BlockContactExec::shared_bytes + static_cast<std::size_t>(job.shared_values) * sizeof(T),
         job);
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

/// Blocks: one per island. Threads: island_threads. Shared: BlockContactExec::shared_bytes,
/// dynamic. Registers: up to 128.
template <class T>
__global__ void __launch_bounds__(island_threads, 4) contact_measure_kernel(MeasureJob<T> job) {
  const auto which = static_cast<std::int64_t>(blockIdx.x);
  BlockContactExec exec(dynamic_shared<unsigned char>());
  const IslandSums sums = measure_island(ContactPipeline<BlockContactExec, T>(
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
         dim3(island_threads), BlockContactExec::shared_bytes, job);
}

}  // namespace tetwarp

/// @file grid_island.cuh
/// Solves a large island in one launch: the threads of all resident blocks share the indices of a
/// stage and synchronize the whole grid after it; all decisions are made on the device.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "kernels/contact/contact_block.cuh"
#include "kernels/exec/exec_buffer.cuh"
#include "kernels/exec/grid_sum.cuh"

namespace tetwarp {

/// The executor of the contact pipeline within a grid whose blocks are all resident. Every thread
/// makes every call and receives the same results. Trees of sums, and the sweeps after which
/// results are read, are those of GridContactExec, so that both have the same bits.
class ResidentGridExec {
 public:
  using LargestSum = IslandExec<island_threads>::LargestSum;
  static constexpr std::size_t shared_bytes = sum_warps * sizeof(LargestSum);
  static constexpr std::size_t state_bytes = 1024;

  /// Bytes of memory for the sums of `terms` terms.
  static std::int64_t sum_bytes(std::int64_t terms) {
    return 2 * runs_of(terms) * static_cast<std::int64_t>(sizeof(LargestSum));
  }

  /// @param state   in memory of the device, [state_bytes]
  /// @param sums    in memory of the device, [sum_bytes(most_terms)]
  /// @param shared  of the block, [shared_bytes]
  __device__ ResidentGridExec(void* state, void* sums, std::int64_t most_terms, void* shared)
      : state_(state),
        sums_(static_cast<LargestSum*>(sums)),
        most_runs_(runs_of(most_terms)),
        shared_(shared) {}

  /// The thread's number within the grid.
  __device__ static std::int64_t first() {
    return std::int64_t{blockIdx.x} * island_threads + threadIdx.x;
  }

  template <class Body>
  __device__ __forceinline__ void for_each(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += stride()) body(i);
    grid_sync();
  }
  template <class Body>
  __device__ __forceinline__ void for_runs(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += stride()) body.template run<1>(i, i + 1);
    grid_sync();
  }
  template <class Body>
  __device__ __forceinline__ void once(const char*, const Body& body) const {
    if (first() == 0) body(0);
    grid_sync();
  }
  __device__ __forceinline__ void once(const char*, const AndersonDecideBody& body) const {
    if (first() < 32) decide_by_lanes(*body.state, static_cast<int>(first()));
    grid_sync();
  }
  template <class State>
  __device__ __forceinline__ State* state() const {
    static_assert(sizeof(State) <= state_bytes && alignof(State) <= 16);
    State* const state = static_cast<State*>(state_);
    if (first() == 0) *state = State{};
    grid_sync();
    return state;
  }
  template <class T>
  __device__ __forceinline__ T load(const T* value) const {
    return *value;
  }
  template <class T>
  __device__ __forceinline__ T load_without_sync(const T*, T otherwise) const {
    return otherwise;
  }
  __device__ __forceinline__ bool is_sync_point(std::int64_t step) const { return step % 8 == 0; }

  template <class T>
  __device__ __forceinline__ void copy(const char*, View<const T> from, View<T> to) const {
    for (std::int64_t i = first(); i < from.size; i += stride()) to[i] = from[i];
    grid_sync();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ Sum
  sum(const char*, std::int64_t begin, std::int64_t end, const Body& body) {
    return begin == end ? Sum{} : sum_terms<Sum>(begin, end, body);
  }
  template <class Sum, class Body>
  __device__ __forceinline__ void sum_to(
      const char*, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) {
    const Sum total = sum_terms<Sum>(begin, end, body);
    if (first() == 0) *out = total;
    grid_sync();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ void sum_runs_to(
      const char* label, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) {
    const auto term = [&](std::int64_t i) { return body.template run<1>(i, i + 1); };
    sum_to<Sum>(label, begin, end, term, out);
  }

 private:
  TETWARP_HD static std::int64_t runs_of(std::int64_t terms) {
    return (terms + sum_run - 1) / sum_run;
  }
  __device__ static std::int64_t stride() { return std::int64_t{gridDim.x} * island_threads; }

  /// Blocks sum runs in turn; then every block sums these sums. Calls use the two halves of the
  /// memory alternately: a block may write the next sums while another still reads the last ones.
  template <class Sum, class Term>
  __device__ __forceinline__ Sum sum_terms(std::int64_t begin, std::int64_t end, const Term& term) {
    static_assert(sizeof(Sum) <= sizeof(LargestSum));
    Sum* const sums = reinterpret_cast<Sum*>(sums_ + (is_second_ ? most_runs_ : 0));
    is_second_ = !is_second_;
    Sum* const of_warp = static_cast<Sum*>(shared_);
    const std::int64_t runs = runs_of(end - begin);
    for (std::int64_t run = blockIdx.x; run < runs; run += gridDim.x) {
      const std::int64_t from = begin + run * sum_run;
      const Sum total = block_sum(terms_of<Sum>(from, min_of(from + sum_run, end), term), of_warp);
      if (threadIdx.x == 0) sums[run] = total;
    }
    grid_sync();
    return block_sum(terms_of<Sum>(0, runs, [=](std::int64_t i) { return sums[i]; }), of_warp);
  }
  template <class Sum, class Term>
  __device__ __forceinline__ static Sum terms_of(std::int64_t begin,
                                                 std::int64_t end,
                                                 const Term& term) {
    Sum mine{};
    for (std::int64_t i = begin + threadIdx.x; i < end; i += sum_threads) mine += term(i);
    return mine;
  }

  void* state_;
  LargestSum* sums_;
  std::int64_t most_runs_;
  void* shared_;
  bool is_second_ = false;
};

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
  void* method_state;  ///< [ResidentGridExec::state_bytes]
  void* sums;          ///< [ResidentGridExec::sum_bytes(most_terms)]
  std::int64_t most_terms;
  View<IslandResult> result;  ///< out, [1]
  View<ContactEvent> events;  ///< out
};

/// Blocks: as many as are resident together, at most. Threads: island_threads. Shared:
/// ResidentGridExec::shared_bytes, dynamic. Registers: up to 255.
template <class T>
__global__ void __launch_bounds__(island_threads, island_blocks)
    contact_grid_kernel(GridIslandJob<T> job) {
  ResidentGridExec exec(job.method_state, job.sums, job.most_terms,
                        dynamic_shared<unsigned char>());
  ContactPipeline<ResidentGridExec, T> pipeline(exec, job.numbers, job.color_start, job.task.island,
                                                job.switches, job.state);
  ThinnedEventLog log(job.events, ResidentGridExec::first() == 0);
  IslandResult result;
  result.end = solve_island(pipeline, job.task.criterion, job.plan, 0, job.work, log);
  result.events = log.end();
  if (ResidentGridExec::first() == 0) job.result[0] = result;
}

/// The largest number of terms that the solve of an island sums.
inline std::int64_t most_terms_of(const ContactIsland& island) {
  return std::max(3 * island.contact_count(), island.block_count());
}

/// Solves an island by one launch on the whole device.
/// @param multiprocessors  of the device, which can synchronize a grid
///
/// Determinism: the bits of the same solve stage by stage with GridContactExec, for any number of
/// blocks. Cost: per stage one synchronization of the grid, besides what the stages cost.
template <class T>
void contact_solve_by_grid(cudaStream_t stream,
                           const GridIslandJob<T>& job,
                           std::int64_t multiprocessors) {
  constexpr std::int64_t entries_per_thread = 4;  // fewer blocks synchronize faster
  int resident = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(
                 &resident, contact_grid_kernel<T>, island_threads, ResidentGridExec::shared_bytes),
             "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  const std::int64_t wanted =
      1 + most_terms_of(job.task.island) / (entries_per_thread * std::int64_t{island_threads});
  const std::int64_t blocks = std::clamp<std::int64_t>(wanted, 1, resident * multiprocessors);
  launch_cooperative(stream, contact_grid_kernel<T>, dim3(static_cast<unsigned>(blocks)),
                     dim3(island_threads), ResidentGridExec::shared_bytes, job);
}

}  // namespace tetwarp

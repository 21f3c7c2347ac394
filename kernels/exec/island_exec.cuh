/// @file island_exec.cuh
/// IslandExec: the executor within one launch, whose threads solve an island together: a warp, a
/// block, or a grid whose blocks are all resident.
#pragma once
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "kernels/base/view.hpp"
#include "kernels/exec/block_sum.cuh"
#include "kernels/exec/grid_sum.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// Room for the largest sum of an executor.
struct LargestSum {
  double value[17];
};

/// One thread's terms of the sum of `term` over [begin, end), those of all threads of a block in
/// turn.
template <class Sum, int threads = sum_threads, class Term>
__device__ __forceinline__ Sum terms_of(std::int64_t begin, std::int64_t end, const Term& term) {
  static_assert(sizeof(Sum) <= sizeof(LargestSum));
  Sum mine{};
  for (std::int64_t i = begin; i < end; i += threads) mine += term(i);
  return mine;
}

/// A block. Its sums have a tree of their own for each number of threads.
/// @tparam threads  of the block, a multiple of 32
template <int threads>
class TeamOfBlock {
 public:
  static constexpr std::size_t shared_bytes = threads / 32 * sizeof(LargestSum);
  static constexpr std::int64_t steps_per_read = 1;  ///< steps between reads of results

  /// @param shared  of the block, [shared_bytes]
  __device__ explicit TeamOfBlock(void* shared) : shared_(shared) {}

  /// The thread's number within the team.
  __device__ static std::int64_t first() { return std::int64_t{threadIdx.x}; }
  __device__ static std::int64_t size() { return threads; }
  __device__ static void wait() { __syncthreads(); }

  template <class Sum, class Term>
  __device__ __forceinline__ Sum sum(std::int64_t begin, std::int64_t end, const Term& term) const {
    return block_sum<threads>(terms_of<Sum, threads>(begin + first(), end, term),
                              static_cast<Sum*>(shared_));
  }

 private:
  void* shared_;
};

using BlockTeam = TeamOfBlock<sum_threads>;

/// A warp. Its sums have the tree of BlockTeam: it computes the parts of the block's warps one
/// after the other.
class WarpTeam {
 public:
  static constexpr std::size_t shared_bytes = 0;
  static constexpr std::int64_t steps_per_read = 1;

  __device__ explicit WarpTeam(void*) {}

  __device__ static std::int64_t first() { return std::int64_t{threadIdx.x} % 32; }
  __device__ static std::int64_t size() { return 32; }
  __device__ static void wait() { __syncwarp(); }

  template <class Sum, class Term>
  __device__ __forceinline__ Sum sum(std::int64_t begin, std::int64_t end, const Term& term) const {
    Sum total{};
    for (std::int64_t part = begin; part < end && part < begin + sum_threads; part += 32) {
      const Sum mine = warp_sum(terms_of<Sum>(part + first(), end, term));
      part == begin ? total = mine : total += mine;
    }
    __syncwarp();  // shuffles order no memory: the terms are read before anything is written next
    return shuffled_from_first(total);
  }
};

/// A grid of blocks of sum_threads threads that are all resident. Trees of sums, and the steps
/// after which results are read, are those of CudaExec, so that both have the same bits.
class GridTeam {
 public:
  static constexpr std::size_t shared_bytes = sum_warps * sizeof(LargestSum);
  static constexpr std::int64_t steps_per_read = 8;

  /// Bytes of memory for the sums of `terms` terms.
  static std::int64_t sum_bytes(std::int64_t terms) {
    return 2 * most_sum_runs_of(terms) * static_cast<std::int64_t>(sizeof(LargestSum));
  }

  /// @param sums    in memory of the device, [sum_bytes(most_terms)]
  /// @param shared  of the block, [shared_bytes]
  __device__ GridTeam(void* sums, std::int64_t most_terms, void* shared)
      : sums_(static_cast<LargestSum*>(sums)),
        most_runs_(most_sum_runs_of(most_terms)),
        shared_(shared) {}

  /// Successive warps are in successive blocks, so that few indices occupy many multiprocessors.
  __device__ static std::int64_t first() {
    const std::int64_t warp = threadIdx.x / 32;
    return (warp * gridDim.x + blockIdx.x) * 32 + threadIdx.x % 32;
  }
  __device__ static std::int64_t size() { return std::int64_t{gridDim.x} * sum_threads; }
  __device__ static void wait() { grid_sync(); }

  /// Blocks sum runs in turn; then every block sums these sums. Calls use the two halves of the
  /// memory alternately: a block may write the next sums while another still reads the last ones.
  template <class Sum, class Term>
  __device__ __forceinline__ Sum sum(std::int64_t begin, std::int64_t end, const Term& term) {
    Sum* const sums = reinterpret_cast<Sum*>(sums_ + (is_second_ ? most_runs_ : 0));
    is_second_ = !is_second_;
    Sum* const of_warp = static_cast<Sum*>(shared_);
    const std::int64_t size = sum_run_of(end - begin), runs = sum_runs_of(end - begin);
    for (std::int64_t run = blockIdx.x; run < runs; run += gridDim.x) {
      const std::int64_t from = begin + run * size;
      const Sum total =
          block_sum(terms_of<Sum>(from + threadIdx.x, min_of(from + size, end), term), of_warp);
      if (threadIdx.x == 0) sums[run] = total;
    }
    grid_sync();
    return block_sum(terms_of<Sum>(threadIdx.x, runs, [=](std::int64_t i) { return sums[i]; }),
                     of_warp);
  }

 private:
  LargestSum* sums_;
  std::int64_t most_runs_;
  void* shared_;
  bool is_second_ = false;
};

/// Every thread of the team makes every call and receives the same results. A barrier ends each
/// stage. Blocks and warps have the same order of updates and the same trees of sums.
/// @tparam Team  WarpTeam, BlockTeam or GridTeam
template <class Team>
class IslandExec {
 public:
  static constexpr std::size_t state_bytes = 1024;
  /// Shared memory of a warp or a block: of its state, and of the team.
  static constexpr std::size_t shared_bytes = state_bytes + Team::shared_bytes;

  /// @param shared  [shared_bytes], of the block or of the warp
  __device__ explicit IslandExec(void* shared)
      : IslandExec(shared, Team(static_cast<unsigned char*>(shared) + state_bytes)) {}
  /// @param state  memory of all threads of the team, [state_bytes]
  __device__ IslandExec(void* state, const Team& team) : state_(state), team_(team) {}

  /// The thread's number within the team.
  __device__ static std::int64_t first() { return Team::first(); }

  template <class Op>
  __device__ __forceinline__ void for_each(const char*, std::int64_t count, const Op& op) const {
    for (std::int64_t i = first(); i < count; i += Team::size()) op(i);
    Team::wait();
  }
  /// op(32 i + lane) for i in [0, count), by whole warps.
  template <class Op>
  __device__ __forceinline__ void for_each_by_warps(std::int64_t count, const Op& op) const {
    for (std::int64_t i = first(); i < 32 * count; i += Team::size()) op(i);
    Team::wait();
  }
  template <class Op>
  __device__ __forceinline__ void for_runs(const char* label,
                                           std::int64_t count,
                                           const Op& op) const {
    for_each(label, count, [&](std::int64_t i) { op.template run<1>(i, i + 1); });
  }
  template <class Op>
  __device__ __forceinline__ void once(const char*, const Op& op) const {
    if (first() == 0) op(0);
    Team::wait();
  }
  /// work(lane) by the lanes of one warp.
  template <class Work>
  __device__ __forceinline__ void once_by_lanes(const Work& work) const {
    if (first() < 32) work(static_cast<int>(first()));
    Team::wait();
  }

  /// Default-constructs a State in memory of the team; replaces that of the previous call.
  template <class State>
  __device__ __forceinline__ State* state() const {
    static_assert(sizeof(State) <= state_bytes && alignof(State) <= 16);
    State* const state = static_cast<State*>(state_);
    if (first() == 0) *state = State{};
    Team::wait();
    return state;
  }
  template <class T>
  __device__ __forceinline__ T load(const T* value) const {
    return *value;
  }
  template <class T>
  __device__ __forceinline__ T load_without_sync(const T* value, T otherwise) const {
    return Team::steps_per_read == 1 ? *value : otherwise;
  }
  __device__ __forceinline__ bool is_sync_point(std::int64_t step) const {
    return step % Team::steps_per_read == 0;
  }

  template <class T>
  __device__ __forceinline__ void copy(const char* label, View<const T> from, View<T> to) const {
    for_each(label, from.size, [&](std::int64_t i) { to[i] = from[i]; });
  }
  template <class Sum, class Op>
  __device__ __forceinline__ Sum
  sum(const char*, std::int64_t begin, std::int64_t end, const Op& op) {
    return begin == end ? Sum{} : team_.template sum<Sum>(begin, end, op);
  }
  template <class Sum, class Op>
  __device__ __forceinline__ void sum_to(
      const char*, std::int64_t begin, std::int64_t end, const Op& op, Sum* out) {
    const Sum total = team_.template sum<Sum>(begin, end, op);
    if (first() == 0) *out = total;
    Team::wait();
  }
  template <class Sum, class Op>
  __device__ __forceinline__ void sum_runs_to(
      const char* label, std::int64_t begin, std::int64_t end, const Op& op, Sum* out) {
    const auto term = [&](std::int64_t i) { return op.template run<1>(i, i + 1); };
    sum_to<Sum>(label, begin, end, term, out);
  }

 private:
  void* state_;
  Team team_;
};

/// The executor of 32 threads, or of sum_threads.
template <int threads>
using ThreadsExec = IslandExec<std::conditional_t<threads == 32, WarpTeam, BlockTeam>>;

}  // namespace tetwarp

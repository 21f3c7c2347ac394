/// @file island_exec.cuh
/// The executor of the contact pipeline within one block or one warp of a device, and the log of
/// residuals of a solve that runs there.
#pragma once
#include <cstdint>

#include "kernels/contact/anderson_lanes.cuh"
#include "kernels/contact/contact_methods.hpp"
#include "kernels/exec/block_sum.cuh"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// The executor of the contact pipeline within a block of 128 threads, or within one warp. Every
/// thread makes every call and receives the same results. Blocks and warps have the same order of
/// updates and the same trees of sums: a warp computes the parts of the block's warps one after the
/// other.
/// @tparam threads  sum_threads, or 32
template <int threads>
class IslandExec {
 public:
  static_assert(threads == sum_threads || threads == 32);
  using LargestSum = PlainSums<2 * anderson_window + 1>;
  static constexpr bool is_warp = threads == 32;
  static constexpr std::size_t state_bytes = 1024;
  static constexpr std::size_t shared_bytes =
      state_bytes + (is_warp ? 0 : sum_warps * sizeof(LargestSum));

  /// @param shared  [shared_bytes], of the block or of the warp
  __device__ explicit IslandExec(void* shared) : shared_(shared) {}

  /// The thread's number within the block or the warp.
  __device__ static std::int64_t first() {
    return static_cast<std::int64_t>(threadIdx.x % threads);
  }

  template <class Body>
  __device__ __forceinline__ void for_each(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += threads) body(i);
    wait();
  }
  template <class Body>
  __device__ __forceinline__ void for_runs(const char*,
                                           std::int64_t count,
                                           const Body& body) const {
    for (std::int64_t i = first(); i < count; i += threads) body.template run<1>(i, i + 1);
    wait();
  }
  template <class Body>
  __device__ __forceinline__ void once(const char*, const Body& body) const {
    if (first() == 0) body(0);
    wait();
  }
  /// By the lanes of a warp.
  __device__ __forceinline__ void once(const char*, const AndersonDecideBody& body) const {
    if (first() < 32) decide_by_lanes(*body.state, static_cast<int>(first()));
    wait();
  }

  /// Default-constructs a State in shared memory; replaces that of the previous call.
  template <class State>
  __device__ __forceinline__ State* state() const {
    static_assert(sizeof(State) <= state_bytes && alignof(State) <= 16);
    State* const state = static_cast<State*>(shared_);
    if (first() == 0) *state = State{};
    wait();
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
    for (std::int64_t i = first(); i < from.size; i += threads) to[i] = from[i];
    wait();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ Sum
  sum(const char*, std::int64_t begin, std::int64_t end, const Body& body) const {
    return sum_terms<Sum>(begin, end, body);
  }

  template <class Sum, class Body>
  __device__ __forceinline__ void sum_to(
      const char*, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) const {
    const Sum total = sum_terms<Sum>(begin, end, body);
    if (first() == 0) *out = total;
    wait();
  }
  template <class Sum, class Body>
  __device__ __forceinline__ void sum_runs_to(
      const char*, std::int64_t begin, std::int64_t end, const Body& body, Sum* out) const {
    const Sum total =
        sum_terms<Sum>(begin, end, [&](std::int64_t i) { return body.template run<1>(i, i + 1); });
    if (first() == 0) *out = total;
    wait();
  }

 private:
  __device__ __forceinline__ static void wait() {
    if constexpr (is_warp) {
      __syncwarp();
    } else {
      __syncthreads();
    }
  }

  template <class Sum, class Term>
  __device__ __forceinline__ Sum sum_terms(std::int64_t begin,
                                           std::int64_t end,
                                           const Term& term) const {
    static_assert(sizeof(Sum) <= sizeof(LargestSum));
    if constexpr (is_warp) {
      Sum total{};
      for (std::int64_t part = begin; part < end && part < begin + sum_threads; part += 32) {
        const Sum mine = warp_sum(terms_of<Sum>(part + first(), end, term));
        part == begin ? total = mine : total += mine;
      }
      return shuffled_from_first(total);
    } else {
      Sum* const sums = reinterpret_cast<Sum*>(static_cast<unsigned char*>(shared_) + state_bytes);
      return block_sum(terms_of<Sum>(begin + first(), end, term), sums);
    }
  }
  template <class Sum, class Term>
  __device__ __forceinline__ static Sum terms_of(std::int64_t begin,
                                                 std::int64_t end,
                                                 const Term& term) {
    Sum mine{};
    for (std::int64_t i = begin; i < end; i += sum_threads) mine += term(i);
    return mine;
  }

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

}  // namespace tetwarp

/// @file exec_cpu.hpp
/// CpuExec: the operations of all pipelines on host threads. Results do not depend on the number of
/// threads: every index writes its own output, scans and sorts are stable, sums have one fixed
/// tree, and lists are in the order of the indices that append to them.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/base/warp_backend.hpp"
#include "host/exec/host_buffer.hpp"
#include "host/exec/host_copies.hpp"
#include "host/exec/host_list.hpp"
#include "host/exec/pair_sort.hpp"
#include "kernels/base/cell_pair.hpp"
#include "kernels/base/grouped_sums.hpp"
#include "kernels/base/lane_sums.hpp"
#include "kernels/base/pair_limit.hpp"
#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Executor for host threads, with the interface of CudaExec.
class CpuExec : public HostCopies {
 public:
  template <class T>
  using List = HostList<T>;

  /// The host can read results without waiting, so that lists are allocated at their exact size.
  static constexpr bool reads_are_free = true;

  /// @param clocks  off: times() are empty
  explicit CpuExec(int threads, StageClocks clocks = StageClocks::on)
      : threads_(threads), clocks_(clocks) {}

  int threads() const { return threads_; }
  std::string device() const { return processor_name(); }
  StageTimes& times() { return times_[flight_]; }

  struct Scope {};  ///< nothing to keep on the host
  /// Selects which of two steps in flight, 0 or 1, the following calls belong to. Every call
  /// returns when its work is done, so that there is nothing to wait for.
  Scope enter(int flight = 0) {
    flight_ = flight;
    return {};
  }

  template <class T>
  void zero(const char* label, View<T> view) const {
    const Clock clock(*this, label);
    std::memset(static_cast<void*>(view.data), 0, static_cast<std::size_t>(view.size) * sizeof(T));
  }
  template <class T>
  void copy(const char* label, View<const T> from, View<T> to) const {
    const Clock clock(*this, label);
    std::copy_n(from.data, from.size, to.data);
  }

  /// op(i) for i in [0, count), any order.
  template <class Op>
  void for_each(const char* label, std::int64_t count, const Op& op) const {
    const Clock clock(*this, label);
    parallel_for(threads_for(count), count, op);
  }
  /// Calls op.finish(i, sum of op.part(i, lane) over Op::lanes lanes) for i in [0, count), in any
  /// order; the sum has the tree of summed_by_lanes().
  template <class Op>
  void for_each_by_lanes(const char* label, std::int64_t count, const Op& op) const {
    for_each(label, count, [&](std::int64_t i) { op.finish(i, summed_by_lanes(op, i)); });
  }
  /// op(0), by a single thread.
  template <class Op>
  void once(const char* label, const Op& op) const {
    const Clock clock(*this, label);
    op(0);
  }
  /// op.run(begin, end) over runs of [0, count), any order.
  template <class Op>
  void for_runs(const char* label, std::int64_t count, const Op& op) const {
    const Clock clock(*this, label);
    parallel_for(threads_for(count), parts_of(count, run_length), [&](std::int64_t run) {
      op.template run<run_length>(run * run_length, std::min((run + 1) * run_length, count));
    });
  }
  /// stage(begin, end) for parts of [0, count) of at most task_length indices, any order.
  template <class Stage>
  void for_ranges(const char* label, std::int64_t count, const Stage& stage) const {
    const Clock clock(*this, label);
    for_tasks(count,
              [&](std::int64_t, std::int64_t begin, std::int64_t end) { stage(begin, end); });
  }
  /// Calls op(segment, local, item) for every item of every segment: offsets[segment] + local =
  /// item. Items from `capacity` on are left out.
  template <class Op>
  void for_each_item(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Op& op) const {
    for_each_span(
        label, offsets, capacity,
        [&](std::int64_t segment, std::int64_t first, std::int64_t past, std::int64_t item) {
          for (; first < past; ++first, ++item) op(segment, first, item);
        });
  }
  /// Calls op(segment, first, past, item) for stretches of successive items of a segment, local
  /// numbers [first, past): offsets[segment] + first = item.
  template <class Op>
  void for_each_span(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Op& op) const {
    const Clock clock(*this, label);
    const std::int64_t segments = offsets.size - 1;
    const std::int64_t items = std::min(offsets[segments], capacity);
    const std::int64_t chunks = parts_of(items, chunk_items);
    parallel_tasks(threads_for(items), chunks, [&](std::int64_t chunk) {
      const std::int64_t end = std::min(items, (chunk + 1) * chunk_items);
      std::int64_t item = chunk * chunk_items;
      std::int64_t segment =
          std::upper_bound(offsets.data, offsets.data + offsets.size, item) - offsets.data - 1;
      for (; item < end; ++segment) {
        const std::int64_t begin = offsets[segment], past = std::min(offsets[segment + 1], end);
        if (item < past) op(segment, item - begin, past - begin, item);
        item = past;
      }
    });
  }

  /// Sum of op(i) for i in [first, last): runs of 64 in sequence, then their sums in sequence.
  template <class Sum, class Op>
  Sum sum(const char* label, std::int64_t first, std::int64_t last, const Op& op) {
    return add_runs<Sum>(label, first, last, [&](std::int64_t begin, std::int64_t end) {
      Sum sum{};
      for (std::int64_t i = begin; i < end; ++i) sum += op(i);
      return sum;
    });
  }
  /// As sum(), into executor memory.
  template <class Sum, class Op>
  void sum_to(const char* label, std::int64_t first, std::int64_t last, const Op& op, Sum* out) {
    *out = sum<Sum>(label, first, last, op);
  }
  /// The same of op.run(begin, end) over runs of at most 64 indices.
  template <class Sum, class Op>
  void sum_runs_to(
      const char* label, std::int64_t first, std::int64_t last, const Op& op, Sum* out) {
    *out = add_runs<Sum>(label, first, last, [&](std::int64_t begin, std::int64_t end) {
      return op.template run<run_length>(begin, end);
    });
  }
  /// Replaces values[i] by the sum of the values before it. The last entry becomes the total; its
  /// own value is ignored.
  void exclusive_scan(const char* label, View<std::int64_t> values) const {
    const Clock clock(*this, label);
    std::int64_t sum = 0;
    for (std::int64_t i = 0; i < values.size; ++i) {
      const std::int64_t value = values[i];
      values[i] = sum;
      sum += value;
    }
  }
  /// Sums op(i) for i in [0, count), and calls op.finish(total, k) for k in [0, sum_group). The
  /// sums before each i are not stored.
  template <class Op>
  void grouped_scan(const char* label, std::int64_t count, const Op& op, const GroupedSums&) {
    const Clock clock(*this, label);
    std::int64_t total = 0;
    for (std::int64_t i = 0; i < count; ++i) total += op(i);
    for (int k = 0; k < sum_group; ++k) op.finish(total, k);
  }

  /// Replaces the list by what op(i, emit) appends for i in [0, count), in order of i:
  /// emit(value) appends one, emit.tally(n) adds n to the list's tally.
  /// @throws TooManyPairs  before memory is taken for more than `most` values
  template <class Op, class T>
  void append(const char* label,
              std::int64_t count,
              const Op& op,
              HostList<T>& list,
              std::int64_t most = unlimited) const {
    const Clock clock(*this, label);
    const std::int64_t tasks = parts_of(count, task_length);
    if (static_cast<std::int64_t>(list.parts_.size()) < tasks) {
      list.parts_.resize(static_cast<std::size_t>(tasks));
    }
    for_tasks(count, [&](std::int64_t task, std::int64_t begin, std::int64_t end) {
      auto& part = list.parts_[static_cast<std::size_t>(task)];
      part.values.clear();
      part.tallied = 0;
      const Op own = op;
      for (std::int64_t i = begin; i < end; ++i) {
        own(i, part);
        check_count(static_cast<std::int64_t>(part.values.size()), most);
      }
    });
    std::int64_t size = 0;
    list.clear();
    for (std::int64_t t = 0; t < tasks; ++t) {
      auto& part = list.parts_[static_cast<std::size_t>(t)];
      part.first = size;
      size += static_cast<std::int64_t>(part.values.size());
      list.tally_ += part.tallied;
    }
    check_count(size, most);
    list.set_size(size);
    T* const to = list.values().data;
    parallel_tasks(threads_, tasks, [&](std::int64_t t) {
      const auto& part = list.parts_[static_cast<std::size_t>(t)];
      std::copy(part.values.begin(), part.values.end(), to + part.first);
    });
  }
  /// Replaces the list by op(i) for i in [0, count).
  template <class Op, class T>
  void fill(const char* label, std::int64_t count, const Op& op, HostList<T>& list) const {
    list.clear();
    list.set_size(count);
    const View<T> values = list.values();
    for_each(label, count, [&](std::int64_t i) { values[i] = op(i); });
  }

  /// Copies the first candidate_count[0] pairs that are not rejected, in order, and counts them.
  void select_valid(const char* label,
                    View<const CellPair> candidates,
                    View<const std::int64_t> candidate_count,
                    View<CellPair> pairs,
                    View<std::int64_t> pair_count) const {
    const Clock clock(*this, label);
    const std::int64_t count = std::min(candidate_count[0], candidates.size);
    pair_count[0] = copy_valid(threads_for(count), {candidates.data, count}, pairs);
  }
  /// Stable sort of the first pair_count[0] pairs by cell, of which the lowest `cell_bits` bits
  /// count.
  void sort_pairs(const char* label,
                  View<CellPair> pairs,
                  View<const std::int64_t> pair_count,
                  int cell_bits) {
    const Clock clock(*this, label);
    sort_.sort(threads_for(pair_count[0]), {pairs.data, pair_count[0]}, cell_bits);
  }
  void sort_pairs(const char* label, HostList<CellPair>& list, int cell_bits) {
    sort_pairs(label, list.values(), {&list.size_, 1}, cell_bits);
  }

  /// Adds the time from its construction to its destruction to the times of a label.
  class Clock {
   public:
    Clock(const CpuExec& exec, const char* label)
        : times_(exec.clocks_ == StageClocks::on ? &exec.times_[exec.flight_] : nullptr),
          label_(label) {
      if (times_ != nullptr) start_ = std::chrono::steady_clock::now();
    }
    ~Clock() {
      if (times_ == nullptr) return;
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
      times_->add(label_, passed.count());
    }
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;

   private:
    StageTimes* times_;
    const char* label_;
    std::chrono::steady_clock::time_point start_;
  };

 private:
  static constexpr std::int64_t run_length = 64;  ///< indices that a sum adds in sequence
  static constexpr std::int64_t task_length = 1024;
  static constexpr std::int64_t chunk_items = 4096;

  static std::int64_t parts_of(std::int64_t count, std::int64_t length) {
    return (count + length - 1) / length;
  }
  /// The one threshold for all loops: what the start of a thread costs.
  int threads_for(std::int64_t count) const { return tetwarp::threads_for(threads_, count); }

  template <class Work>
  void for_tasks(std::int64_t count, const Work& work) const {
    parallel_tasks(threads_, parts_of(count, task_length), [&](std::int64_t task) {
      work(task, task * task_length, std::min(count, (task + 1) * task_length));
    });
  }

  /// Sum of what run(begin, end) returns for runs of [first, last).
  template <class Sum, class Run>
  Sum add_runs(const char* label, std::int64_t first, std::int64_t last, const Run& run) {
    const Clock clock(*this, label);
    const std::int64_t runs = parts_of(last - first, run_length);
    const auto run_sum = [&](std::int64_t r) {
      const std::int64_t begin = first + r * run_length;
      return run(begin, std::min(begin + run_length, last));
    };
    Sum total{};
    const int threads = threads_for(last - first);
    if (threads == 1) {
      for (std::int64_t r = 0; r < runs; ++r) total += run_sum(r);
      return total;
    }
    sums_.reserve(runs * static_cast<std::int64_t>(sizeof(Sum)));
    Sum* const sums = reinterpret_cast<Sum*>(sums_.view(0).data);
    parallel_for(threads, runs, [&](std::int64_t r) { new (sums + r) Sum(run_sum(r)); });
    for (std::int64_t r = 0; r < runs; ++r) total += sums[r];
    return total;
  }

  int threads_;
  StageClocks clocks_;
  mutable StageTimes times_[2];  ///< per step in flight
  int flight_ = 0;
  HostBuffer<std::byte> sums_;  ///< of runs
  PairSort sort_;
};

}  // namespace tetwarp

/// @file contact_exec_cpu.hpp
/// CpuContactExec: the executor of the contact pipeline on host threads. Sums have one fixed tree,
/// so results do not depend on the number of threads. Labels of stages are ignored.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/exec/host_buffer.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

class CpuContactExec {
 public:
  explicit CpuContactExec(int threads) : threads_(threads) {}

  template <class T>
  using Vector = std::vector<T>;
  template <class T>
  using Buffer = HostBuffer<T>;

  int threads() const { return threads_; }

  /// Sets the size; all entries become zero.
  template <class T>
  void resize(std::vector<T>& values, std::int64_t size) const {
    values.assign(static_cast<std::size_t>(size), T{});
  }
  /// Copies from the host to memory of the executor.
  template <class T>
  void put(const T* host, std::int64_t size, std::vector<T>& values) const {
    values.assign(host, host + size);
  }
  /// Copies from memory of the executor to the host.
  template <class T>
  void get(View<const T> values, T* host) const {
    std::copy_n(values.data, values.size, host);
  }

  /// body(i) for i in [0, count), any order.
  template <class Body>
  void for_each(const char*, std::int64_t count, const Body& body) const {
    parallel_for(threads_for(count), count, body);
  }

  template <class T>
  void copy(const char*, View<const T> from, View<T> to) const {
    std::copy_n(from.data, from.size, to.data);
  }

  /// body.run(begin, end) over runs of [0, count), any order.
  template <class Body>
  void for_runs(const char*, std::int64_t count, const Body& body) const {
    const std::int64_t runs = (count + run_length - 1) / run_length;
    const auto run = [&](std::int64_t i) {
      body.template run<run_length>(i * run_length, std::min((i + 1) * run_length, count));
    };
    parallel_for(threads_for(count), runs, run);
  }
  /// body(0), by a single thread.
  template <class Body>
  void once(const char*, const Body& body) const {
    body(0);
  }

  /// Default-constructs a State in memory of the executor; replaces that of the previous call.
  template <class State>
  State* state() {
    static_assert(sizeof(State) <= sizeof(state_) && alignof(State) <= 16);
    return new (state_) State{};
  }
  /// Reads one value of executor memory; on a device this synchronizes.
  template <class T>
  T load(const T* value) const {
    return *value;
  }
  /// The value, or the second argument where reading it would synchronize.
  template <class T>
  T load_without_sync(const T* value, T) const {
    return *value;
  }
  /// Whether the host reads results after this step. A device returns true every few steps only.
  bool is_sync_point(std::int64_t) const { return true; }
  static constexpr bool reads_need_sync = false;

  /// As sum(), into executor memory.
  template <class Sum, class Body>
  void sum_to(
      const char* stage, std::int64_t first, std::int64_t last, const Body& body, Sum* out) const {
    *out = sum<Sum>(stage, first, last, body);
  }
  /// As sum_runs(), into executor memory.
  template <class Sum, class Body>
  void sum_runs_to(
      const char* stage, std::int64_t first, std::int64_t last, const Body& body, Sum* out) const {
    *out = sum_runs<Sum>(stage, first, last, body);
  }

  /// Sum of body(i) for i in [first, last): runs of 64 in sequence, then their sums in sequence.
  template <class Sum, class Body>
  Sum sum(const char*, std::int64_t first, std::int64_t last, const Body& body) const {
    return add_runs<Sum>(first, last, [&](std::int64_t begin, std::int64_t end) {
      Sum sum{};
      for (std::int64_t i = begin; i < end; ++i) sum += body(i);
      return sum;
    });
  }

  /// Sum of body.run(begin, end) over runs of at most 64 indices of [first, last), in sequence.
  template <class Sum, class Body>
  Sum sum_runs(const char*, std::int64_t first, std::int64_t last, const Body& body) const {
    return add_runs<Sum>(first, last, [&](std::int64_t begin, std::int64_t end) {
      return body.template run<run_length>(begin, end);
    });
  }

 private:
  static constexpr int run_length = 64;
  static constexpr std::int64_t serial_below = 1024;  ///< with fewer indices one thread is faster

  int threads_for(std::int64_t count) const { return count < serial_below ? 1 : threads_; }

  template <class Sum, class Run>
  Sum add_runs(std::int64_t first, std::int64_t last, const Run& body) const {
    const std::int64_t runs = (last - first + run_length - 1) / run_length;
    const auto run_sum = [&](std::int64_t run) {
      const std::int64_t begin = first + run * run_length;
      return body(begin, std::min(begin + run_length, last));
    };
    Sum total{};
    const int threads = threads_for(last - first);
    if (threads == 1) {
      for (std::int64_t run = 0; run < runs; ++run) total += run_sum(run);
      return total;
    }
    std::vector<Sum> sums(static_cast<std::size_t>(runs));
    parallel_for(threads, runs,
                 [&](std::int64_t run) { sums[static_cast<std::size_t>(run)] = run_sum(run); });
    for (const Sum& sum : sums) total += sum;
    return total;
  }

  int threads_;
  alignas(16) std::byte state_[1024];
};

}  // namespace tetwarp

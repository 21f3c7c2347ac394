/// @file detect_exec_cpu.hpp
/// CpuDetectExec: the executor of DetectorPipeline on host threads. Lists are in the order of the
/// indices that append to them, for any number of threads.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/collide/pair_limit.hpp"
#include "host/exec/exec_cpu.hpp"
#include "host/exec/host_buffer.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// A list that a stage appends to. Memory is kept when it is cleared.
template <class T>
class HostList {
 public:
  std::int64_t size() const { return size_; }
  View<const T> view() const { return values_.const_view(size_); }
  View<T> values() { return values_.view(size_); }
  /// Sum of what the indices of append() tallied.
  std::int64_t tally() const { return tally_; }
  void clear() { size_ = tally_ = 0; }

 private:
  friend class CpuDetectExec;

  /// What the indices of one task append.
  struct Part {
    std::vector<T> values;
    std::int64_t tallied = 0, first = 0;

    void operator()(const T& value) { values.push_back(value); }
    void tally(std::int64_t count) { tallied += count; }
  };

  HostBuffer<T> values_;
  std::int64_t size_ = 0, tally_ = 0;
  std::vector<Part> parts_;
};

class CpuDetectExec {
 public:
  template <class T>
  using Vector = std::vector<T>;
  template <class T>
  using List = HostList<T>;

  static constexpr bool reads_are_free = true;  ///< the host may read what stages read

  explicit CpuDetectExec(int threads) : exec_(threads) {}

  /// Sets the size; new entries are undefined.
  template <class T>
  void resize(std::vector<T>& values, std::int64_t size) const {
    values.resize(static_cast<std::size_t>(size));
  }
  /// Copies from the host to memory of the executor.
  template <class T>
  void put(const T* host, std::int64_t size, std::vector<T>& values) const {
    values.assign(host, host + size);
  }
  /// Host memory for stages to read: used in place. Other executors copy it to `own`.
  template <class T>
  View<const T> input(const T* host, std::int64_t size, std::vector<T>&) const {
    return {host, size};
  }
  /// Values that stages read later: used in place, since the caller of the detector keeps them
  /// unchanged. Other executors copy them to `own`.
  template <class T>
  View<const T> keep(View<const T> values, std::vector<T>&) const {
    return values;
  }
  /// What stages wrote, for the host to read: used in place. Other executors copy it.
  template <class T>
  View<const T> on_host(View<const T> values, std::vector<T>&) const {
    return values;
  }
  template <class T>
  View<T> view(std::vector<T>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }
  template <class T>
  View<const T> view(const std::vector<T>& values) const {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }

  /// body(i) for i in [0, count), any order.
  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    const CpuExec::Clock clock(exec_, label);
    for_tasks(count, [&](std::int64_t, std::int64_t begin, std::int64_t end) {
      const Body own = body;
      for (std::int64_t i = begin; i < end; ++i) own(i);
    });
  }

  /// Replaces the list by what body(i, emit) appends for i in [0, count), in order of i:
  /// emit(value) appends one, emit.tally(n) adds n to the list's tally.
  /// @throws TooManyPairs  before memory is taken for more than `most` values
  template <class Body, class T>
  void append(const char* label,
              std::int64_t count,
              const Body& body,
              HostList<T>& list,
              std::int64_t most = unlimited) {
    const CpuExec::Clock clock(exec_, label);
    const std::int64_t tasks = task_count(count);
    if (static_cast<std::int64_t>(list.parts_.size()) < tasks) {
      list.parts_.resize(static_cast<std::size_t>(tasks));
    }
    for_tasks(count, [&](std::int64_t task, std::int64_t begin, std::int64_t end) {
      auto& part = list.parts_[static_cast<std::size_t>(task)];
      part.values.clear();
      part.tallied = 0;
      const Body own = body;
      for (std::int64_t i = begin; i < end; ++i) {
        own(i, part);
        check_count(static_cast<std::int64_t>(part.values.size()), most);
      }
    });
    list.clear();
    for (std::int64_t t = 0; t < tasks; ++t) {
      auto& part = list.parts_[static_cast<std::size_t>(t)];
      part.first = list.size_;
      list.size_ += static_cast<std::int64_t>(part.values.size());
      list.tally_ += part.tallied;
    }
    check_count(list.size_, most);
    if (list.size_ > list.values_.capacity()) list.values_.reserve(list.size_ + list.size_ / 2);
    T* const to = list.values_.view(list.size_).data;
    parallel_tasks(exec_.threads(), tasks, [&](std::int64_t t) {
      const auto& part = list.parts_[static_cast<std::size_t>(t)];
      std::copy(part.values.begin(), part.values.end(), to + part.first);
    });
  }

  /// Replaces the list by body(i) for i in [0, count).
  template <class Body, class T>
  void fill(const char* label, std::int64_t count, const Body& body, HostList<T>& list) {
    list.clear();
    list.size_ = count;
    if (count > list.values_.capacity()) list.values_.reserve(count + count / 2);
    const View<T> values = list.values();
    for_each(label, count, [&](std::int64_t i) { values[i] = body(i); });
  }

  /// Waits for all work.
  void wait() const {}
  /// Stable sort by the upper 32 bits, of which the lowest `key_bits` count.
  void sort_pairs(const char* label, HostList<CellPair>& list, int key_bits) {
    exec_.sort_pairs(label, list.values_.view(list.size_), {&list.size_, 1}, key_bits);
  }

  StageTimes& times() { return exec_.times(); }

 private:
  static constexpr std::int64_t task_length = 1024;  ///< indices of a task

  static std::int64_t task_count(std::int64_t count) {
    return (count + task_length - 1) / task_length;
  }
  template <class Work>
  void for_tasks(std::int64_t count, const Work& work) {
    parallel_tasks(exec_.threads(), task_count(count), [&](std::int64_t task) {
      work(task, task * task_length, std::min(count, (task + 1) * task_length));
    });
  }

  CpuExec exec_;
};

}  // namespace tetwarp

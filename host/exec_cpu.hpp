/// @file exec_cpu.hpp
/// CpuExec: the operations a pipeline is made of, on host threads. Results do not depend on how
/// many threads there are: every index writes its own output, scans and sorts are stable.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "host/stage_times.hpp"
#include "host/warp_backend.hpp"
#include "kernels/cell_cull.hpp"
#include "kernels/view.hpp"

namespace tetwarp {

/// Owns host memory that only grows; contents are undefined after growth.
template <class T>
class HostBuffer {
 public:
  void reserve(std::int64_t size) {
    if (size <= capacity_) return;
    data_ = std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(size));
    capacity_ = size;
  }
  std::int64_t capacity() const { return capacity_; }
  View<T> view(std::int64_t size) const { return {data_.get(), size}; }
  View<const T> const_view(std::int64_t size) const { return {data_.get(), size}; }

 private:
  std::unique_ptr<T[]> data_;
  std::int64_t capacity_ = 0;
};

class CpuExec {
 public:
  template <class T>
  using Buffer = HostBuffer<T>;

  /// Sizes can be read between stages for nothing, so buffers are always made to measure.
  static constexpr bool reads_are_free = true;

  explicit CpuExec(int threads) : threads_(threads) {}

  int threads() const { return threads_; }
  std::string device() const { return processor_name(); }
  StageTimes& times() { return times_; }

  /// Host memory for a stage to read: no copy.
  template <class T>
  View<const T> resident(const char*, const T* host, std::int64_t size, Buffer<T>&) {
    return {host, size};
  }
  /// Host memory for a stage to write: no copy.
  template <class T>
  T* writable(T* host, std::int64_t, Buffer<T>&) {
    return host;
  }
  /// Brings what was written to writable() memory home: it is there.
  template <class T>
  void deliver(const char*, View<const T>, T*) {}

  /// The value of a few entries, once all stages before have run.
  template <class T>
  void read(View<const T> from, T* to) {
    std::copy_n(from.data, from.size, to);
  }
  template <class T>
  void zero(const char* label, View<T> view) {
    const Clock clock(*this, label);
    std::memset(static_cast<void*>(view.data), 0, static_cast<std::size_t>(view.size) * sizeof(T));
  }

  /// body(i) for i in [0, count).
  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    const Clock clock(*this, label);
#pragma omp parallel for schedule(static) num_threads(threads_) if (count > serial_below)
    for (std::int64_t i = 0; i < count; ++i) body(i);
  }

  /// body(segment, local, item) for every item of every segment: offsets[s] + local = item.
  /// Items from `capacity` on are left out.
  template <class Body>
  void for_each_item(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Body& body) {
    const Clock clock(*this, label);
    const std::int64_t segments = offsets.size - 1;
    const std::int64_t items = std::min(offsets[segments], capacity);
    const std::int64_t chunks = (items + chunk_ - 1) / chunk_;
#pragma omp parallel for schedule(dynamic) num_threads(threads_) if (items > serial_below)
    for (std::int64_t chunk = 0; chunk < chunks; ++chunk) {
      const std::int64_t end = std::min(items, (chunk + 1) * chunk_);
      std::int64_t item = chunk * chunk_;
      std::int64_t segment =
          std::upper_bound(offsets.data, offsets.data + offsets.size, item) - offsets.data - 1;
      for (; item < end; ++item) {
        while (offsets[segment + 1] <= item) ++segment;
        body(segment, item - offsets[segment], item);
      }
    }
  }

  /// values[i] becomes the sum of the values before it; the last entry, whatever it held, the
  /// total.
  void exclusive_scan(const char* label, View<std::int64_t> values) {
    const Clock clock(*this, label);
    std::int64_t sum = 0;
    for (std::int64_t i = 0; i < values.size; ++i) {
      const std::int64_t value = values[i];
      values[i] = sum;
      sum += value;
    }
  }

  /// Marks pairs that no later stage may read by accident; here stages stop at the count.
  void reject_all(const char*, View<CellPair>) {}

  /// Copies the pairs that are not rejected, in their order, and counts them.
  void select_valid(const char* label,
                    View<const CellPair> candidates,
                    View<const std::int64_t> candidate_count,
                    View<CellPair> pairs,
                    View<std::int64_t> pair_count) {
    const Clock clock(*this, label);
    std::int64_t kept = 0;
    const std::int64_t count = std::min(candidate_count[0], candidates.size);
    for (std::int64_t i = 0; i < count; ++i) {
      pairs[kept] = candidates[i];
      kept += candidates[i] != rejected_pair;
    }
    pair_count[0] = kept;
  }

  /// Stable radix sort by cell of the first pair_count[0] pairs.
  void sort_pairs(const char* label,
                  View<CellPair> pairs,
                  View<const std::int64_t> pair_count,
                  int cell_bits) {
    const Clock clock(*this, label);
    const std::int64_t count = pair_count[0];
    scratch_.resize(static_cast<std::size_t>(count));
    CellPair* from = pairs.data;
    CellPair* to = scratch_.data();
    for (int shift = 32; shift < 32 + cell_bits; shift += radix_bits) {
      std::int64_t begin[1 << radix_bits] = {};
      for (std::int64_t i = 0; i < count; ++i) ++begin[from[i] >> shift & radix_mask];
      std::int64_t sum = 0;
      for (std::int64_t& entry : begin) {
        const std::int64_t size = entry;
        entry = sum;
        sum += size;
      }
      for (std::int64_t i = 0; i < count; ++i) to[begin[from[i] >> shift & radix_mask]++] = from[i];
      std::swap(from, to);
    }
    if (from != pairs.data) std::copy_n(from, count, pairs.data);
  }

  /// The caller's stream: there is none here.
  void use_stream(void*) {}

  /// Adds its life time to a label.
  class Clock {
   public:
    Clock(CpuExec& exec, const char* label)
        : exec_(exec), label_(label), start_(std::chrono::steady_clock::now()) {}
    ~Clock() {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
      exec_.times_.add(label_, passed.count());
    }
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;

   private:
    CpuExec& exec_;
    const char* label_;
    std::chrono::steady_clock::time_point start_;
  };

 private:
  static constexpr std::int64_t serial_below = 2048;  ///< starting threads costs more than that
  static constexpr std::int64_t chunk_ = 4096;
  static constexpr int radix_bits = 11;
  static constexpr CellPair radix_mask = (1 << radix_bits) - 1;

  int threads_;
  StageTimes times_;
  std::vector<CellPair> scratch_;
};

}  // namespace tetwarp

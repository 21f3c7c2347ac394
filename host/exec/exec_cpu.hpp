/// @file exec_cpu.hpp
/// CpuExec: the operations of a pipeline on host threads. Results do not depend on the number of
/// threads: every index writes its own output, scans and sorts are stable.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "host/base/parallel.hpp"
#include "host/base/warp_backend.hpp"
#include "host/exec/host_buffer.hpp"
#include "kernels/base/cell_pair.hpp"
#include "kernels/base/grouped_sums.hpp"
#include "kernels/base/slice_bytes.hpp"
#include "kernels/base/stage_times.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Executor for host threads, with the interface of CudaExec. Copies between host and device are
/// no-ops: stages read and write the memory of the caller.
class CpuExec {
 public:
  template <class T>
  using Buffer = HostBuffer<T>;
  template <class T>
  using PinnedBuffer = HostBuffer<T>;
  template <class T>
  struct Staged {};  ///< empty: the argument of upload() is read in place

  /// The host can read results without waiting, so that lists are allocated at their exact size.
  static constexpr bool reads_are_free = true;

  explicit CpuExec(int threads) : threads_(threads) {}

  int threads() const { return threads_; }
  std::string device() const { return processor_name(); }
  StageTimes& times() { return times_[flight_]; }

  struct Scope {};  ///< nothing to keep on the host
  /// Selects which of two steps in flight, 0 or 1, the following calls belong to. Every call
  /// returns when its work is done, so that there is nothing to wait for.
  Scope enter(int flight) {
    flight_ = flight;
    return {};
  }
  void begin_compute(void*, bool) {}
  void end_compute(bool) {}
  void wait_computed() {}
  void end_download() {}
  void wait_delivered() {}
  void drain() noexcept {}

  /// Host memory for a stage to read: no copy.
  template <class T>
  View<const T> resident(const char*, const T* host, std::int64_t size, Buffer<T>&) {
    return {host, size};
  }
  template <class T>
  View<const T> upload(const char*, const T* host, std::int64_t size, Staged<T>&) {
    return {host, size};
  }
  /// Host memory for a stage to write: no copy.
  template <class T>
  T* writable(T* host, std::int64_t, Buffer<T>&) {
    return host;
  }
  /// Copies writable() memory to the host: stages have written to it directly.
  void download(const char*, const std::byte*, std::byte*, const SliceBytes&) {}
  bool downloads_async(const void*) const { return true; }

  /// Copies entries to the host after all preceding stages.
  template <class T>
  void read(View<const T> from, T* to) {
    std::copy_n(from.data, from.size, to);
  }
  template <class T>
  void fetch(View<const T> from, PinnedBuffer<T>& to) {
    read(from, to.view(from.size).data);
  }
  template <class T>
  void zero(const char* label, View<T> view) {
    const Clock clock(*this, label);
    std::memset(static_cast<void*>(view.data), 0, static_cast<std::size_t>(view.size) * sizeof(T));
  }

  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    const Clock clock(*this, label);
    parallel_for(threads_for(count), count, body);
  }

  /// Calls body(segment, local, item) for every item of every segment: offsets[segment] + local =
  /// item. Items from `capacity` on are left out.
  template <class Body>
  void for_each_item(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Body& body) {
    for_each_span(
        label, offsets, capacity,
        [&](std::int64_t segment, std::int64_t first, std::int64_t past, std::int64_t item) {
          for (; first < past; ++first, ++item) body(segment, first, item);
        });
  }

  /// Calls body(segment, first, past, item) for stretches of successive items of a segment, local
  /// numbers [first, past): offsets[segment] + first = item.
  template <class Body>
  void for_each_span(const char* label,
                     View<const std::int64_t> offsets,
                     std::int64_t capacity,
                     const Body& body) {
    const Clock clock(*this, label);
    const std::int64_t segments = offsets.size - 1;
    const std::int64_t items = std::min(offsets[segments], capacity);
    const std::int64_t chunks = (items + chunk_items - 1) / chunk_items;
    parallel_tasks(threads_for(items), chunks, [&](std::int64_t chunk) {
      const std::int64_t end = std::min(items, (chunk + 1) * chunk_items);
      std::int64_t item = chunk * chunk_items;
      std::int64_t segment =
          std::upper_bound(offsets.data, offsets.data + offsets.size, item) - offsets.data - 1;
      for (; item < end; ++segment) {
        const std::int64_t begin = offsets[segment], past = std::min(offsets[segment + 1], end);
        if (item < past) body(segment, item - begin, past - begin, item);
        item = past;
      }
    });
  }

  /// Replaces values[i] by the sum of the values before it. The last entry becomes the total; its
  /// own value is ignored.
  void exclusive_scan(const char* label, View<std::int64_t> values) {
    const Clock clock(*this, label);
    std::int64_t sum = 0;
    for (std::int64_t i = 0; i < values.size; ++i) {
      const std::int64_t value = values[i];
      values[i] = sum;
      sum += value;
    }
  }

  /// Sums body(i) for i in [0, count), and calls body.finish(total, k) for k in [0, sum_group). The
  /// sums before each i are not stored.
  template <class Body>
  void grouped_scan(const char* label, std::int64_t count, const Body& body, const GroupedSums&) {
    const Clock clock(*this, label);
    std::int64_t total = 0;
    for (std::int64_t i = 0; i < count; ++i) total += body(i);
    for (int k = 0; k < sum_group; ++k) body.finish(total, k);
  }

  /// Copies the first candidate_count[0] pairs that are not rejected, in order, and counts them.
  void select_valid(const char* label,
                    View<const CellPair> candidates,
                    View<const std::int64_t> candidate_count,
                    View<CellPair> pairs,
                    View<std::int64_t> pair_count) {
    const Clock clock(*this, label);
    const std::int64_t count = std::min(candidate_count[0], candidates.size);
    std::vector<std::int64_t> kept(static_cast<std::size_t>(threads_ + 1));
    for_each_part(count, [&](int part, std::int64_t begin, std::int64_t end) {
      std::int64_t sum = 0;
      for (std::int64_t i = begin; i < end; ++i) sum += candidates[i] != rejected_pair;
      kept[static_cast<std::size_t>(part + 1)] = sum;
    });
    for (std::size_t p = 1; p < kept.size(); ++p) kept[p] += kept[p - 1];
    for_each_part(count, [&](int part, std::int64_t begin, std::int64_t end) {
      std::int64_t to = kept[static_cast<std::size_t>(part)];
      const std::int64_t past = kept[static_cast<std::size_t>(part + 1)];
      for (std::int64_t i = begin; i < end && to < past; ++i) {
        pairs[to] = candidates[i];
        to += candidates[i] != rejected_pair;
      }
    });
    pair_count[0] = kept.back();
  }

  /// Stable radix sort by cell of the first pair_count[0] pairs.
  void sort_pairs(const char* label,
                  View<CellPair> pairs,
                  View<const std::int64_t> pair_count,
                  int cell_bits) {
    const Clock clock(*this, label);
    const std::int64_t count = pair_count[0];
    scratch_.reserve(count);
    CellPair* from = pairs.data;
    CellPair* to = scratch_.view(count).data;
    // As few passes as possible, with digits of about the same size.
    const int passes = (cell_bits + radix_bits - 1) / radix_bits;
    for (int pass = 0; pass < passes; ++pass) {
      const int shift = 32 + cell_bits * pass / passes;
      const int bits = 32 + cell_bits * (pass + 1) / passes - shift;
      sort_digit(from, to, count, shift, bits);
      std::swap(from, to);
    }
    if (from != pairs.data) std::copy_n(from, count, pairs.data);
  }

  /// Adds the time from its construction to its destruction to the times of a label.
  class Clock {
   public:
    Clock(CpuExec& exec, const char* label)
        : exec_(exec), label_(label), start_(std::chrono::steady_clock::now()) {}
    ~Clock() {
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start_;
      exec_.times().add(label_, passed.count());
    }
    Clock(const Clock&) = delete;
    Clock& operator=(const Clock&) = delete;

   private:
    CpuExec& exec_;
    const char* label_;
    std::chrono::steady_clock::time_point start_;
  };

 private:
  int threads_for(std::int64_t count) const { return count > serial_below ? threads_ : 1; }

  /// Calls work(part, begin, end) for the part of [0, count) of every thread; parts ascend.
  template <class Work>
  void for_each_part(std::int64_t count, const Work& work) {
    parallel_tasks(threads_for(count), threads_, [&](std::int64_t part) {
      work(static_cast<int>(part), count * part / threads_, count * (part + 1) / threads_);
    });
  }

  /// One pass of the radix sort: stable, by `bits` bits from bit `shift` on.
  void sort_digit(const CellPair* from, CellPair* to, std::int64_t count, int shift, int bits) {
    const std::int64_t digits = std::int64_t{1} << bits;
    const CellPair mask = static_cast<CellPair>(digits - 1);
    places_.assign(static_cast<std::size_t>(digits * threads_), 0);
    for_each_part(count, [&](int part, std::int64_t begin, std::int64_t end) {
      std::int64_t* place = places_.data() + digits * part;
      for (std::int64_t i = begin; i < end; ++i) ++place[from[i] >> shift & mask];
    });
    std::int64_t sum = 0;
    for (std::int64_t digit = 0; digit < digits; ++digit) {
      for (int part = 0; part < threads_; ++part) {
        std::int64_t& place = places_[static_cast<std::size_t>(digits * part + digit)];
        const std::int64_t size = place;
        place = sum;
        sum += size;
      }
    }
    for_each_part(count, [&](int part, std::int64_t begin, std::int64_t end) {
      std::int64_t* place = places_.data() + digits * part;
      for (std::int64_t i = begin; i < end; ++i) to[place[from[i] >> shift & mask]++] = from[i];
    });
  }

  static constexpr std::int64_t serial_below = 2048;  ///< with fewer items one thread is faster
  static constexpr std::int64_t chunk_items = 4096;
  static constexpr int radix_bits = 11;

  int threads_;
  StageTimes times_[2];  ///< per step in flight
  int flight_ = 0;
  HostBuffer<CellPair> scratch_;
  std::vector<std::int64_t> places_;  ///< of the sort, [thread][digit]
};

}  // namespace tetwarp

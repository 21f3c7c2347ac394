/// @file detect_exec_cuda.cuh
/// CudaDetectExec: the executor of DetectorPipeline on a device; functions as those of
/// CpuDetectExec.
#pragma once
#include <cstdint>
#include <vector>

#include "host/collide/pair_limit.hpp"
#include "kernels/base/view.hpp"
#include "kernels/exec/device_vector.cuh"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

/// Counts what one index appends.
struct CountingEmit {
  std::int64_t values = 0, tallied = 0;
  template <class T>
  __device__ void operator()(const T&) {
    ++values;
  }
  __device__ void tally(std::int64_t count) { tallied += count; }
};

/// Writes what one index appends.
template <class T>
struct WritingEmit {
  T* to;
  __device__ void operator()(const T& value) { *to++ = value; }
  __device__ void tally(std::int64_t) {}
};

/// One index = one index of the body.
template <class Body>
struct AppendCountBody {
  static constexpr int resident_blocks = 1;  ///< else registers of some bodies are spilled

  Body body;
  View<std::int64_t> counts, tallies;  ///< out
  __device__ void operator()(std::int64_t i) const {
    CountingEmit emit;
    body(i, emit);
    counts[i] = emit.values;
    tallies[i] = emit.tallied;
  }
};
/// Reads two ends of the sums of what indices append.
struct AppendTotalsBody {
  View<const std::int64_t> sums;  ///< exclusive, of the counts and then of the tallies
  View<std::int64_t> totals;      ///< out [2] number of values, tally

  __device__ void operator()(std::int64_t) const {
    const std::int64_t count = sums.size / 2;
    totals[0] = sums[count];
    totals[1] = sums[2 * count] - sums[count];
  }
};
template <class Body, class T>
struct AppendWriteBody {
  static constexpr int resident_blocks = 1;  ///< else registers of some bodies are spilled

  Body body;
  View<const std::int64_t> first;
  View<T> values;  ///< out
  __device__ void operator()(std::int64_t i) const {
    WritingEmit<T> emit{values.data + first[i]};
    body(i, emit);
  }
};

/// Writes the value of one index.
template <class Body, class T>
struct ListFillBody {
  Body body;
  View<T> values;  ///< out
  __device__ void operator()(std::int64_t i) const { values[i] = body(i); }
};

template <class T>
class DeviceList {
 public:
  std::int64_t size() const { return size_; }
  View<const T> view() const { return values_.const_view(size_); }
  View<T> values() { return values_.view(size_); }
  std::int64_t tally() const { return tally_; }
  void clear() { size_ = tally_ = 0; }

 private:
  friend class CudaDetectExec;
  DeviceBuffer<T> values_;
  std::int64_t capacity_ = 0, size_ = 0, tally_ = 0;
};

class CudaDetectExec {
 public:
  template <class T>
  using Vector = DeviceVector<T>;
  template <class T>
  using List = DeviceList<T>;

  static constexpr bool reads_are_free = false;

  explicit CudaDetectExec(int device) : exec_(device) {}

  /// @returns  an object during whose life the device is the current one of this thread
  DeviceScope enter() {
    exec_.times().clear();  // reads of the last call have waited for its work
    return exec_.enter(0);
  }

  template <class T>
  void resize(Vector<T>& values, std::int64_t size) {
    values.resize(size);
  }
  template <class T>
  void put(const T* host, std::int64_t size, Vector<T>& values) {
    values.resize(size);
    if (size == 0) return;
    check_cuda(cudaMemcpyAsync(values.view().data, host, static_cast<std::size_t>(size) * sizeof(T),
                               cudaMemcpyHostToDevice, exec_.stream()),
               "cudaMemcpyAsync to device");
  }
  template <class T>
  View<const T> input(const T* host, std::int64_t size, Vector<T>& own) {
    put(host, size, own);
    return own.view();
  }
  template <class T>
  View<const T> keep(View<const T> values, Vector<T>& own) {
    own.resize(values.size);
    if (values.size > 0) {
      check_cuda(cudaMemcpyAsync(own.view().data, values.data,
                                 static_cast<std::size_t>(values.size) * sizeof(T),
                                 cudaMemcpyDeviceToDevice, exec_.stream()),
                 "cudaMemcpyAsync on device");
    }
    return own.view();
  }
  template <class T>
  View<const T> on_host(View<const T> values, std::vector<T>& host) {
    host.resize(static_cast<std::size_t>(values.size));
    if (values.size > 0) exec_.read(values, host.data());
    return {host.data(), values.size};
  }
  template <class T>
  View<T> view(Vector<T>& values) const {
    return values.view();
  }
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return values.view();
  }

  template <class Body>
  void for_each(const char* label, std::int64_t count, const Body& body) {
    exec_.for_each(label, count, body);
  }
  /// Runs the body twice: to count, and to write.
  template <class Body, class T>
  void append(const char* label,
              std::int64_t count,
              const Body& body,
              DeviceList<T>& list,
              std::int64_t most = unlimited) {
    list.clear();
    if (count == 0) return;
    sums_.resize(2 * count + 1);
    totals_.resize(2);
    std::int64_t* const sums = sums_.view().data;
    exec_.for_each(label, count, AppendCountBody<Body>{body, {sums, count}, {sums + count, count}});
    exec_.exclusive_scan(label, sums_.view());
    exec_.for_each(label, 1, AppendTotalsBody{sums_.view(), totals_.view()});
    std::int64_t totals[2];
    exec_.read(View<const std::int64_t>(totals_.view()), totals);
    check_count(totals[0], most);
    list.tally_ = totals[1];
    set_size(list, totals[0]);
    if (list.size_ == 0) return;
    const AppendWriteBody<Body, T> write{body, sums_.view(), list.values_.view(list.size_)};
    exec_.for_each(label, count, write);
  }
  template <class Body, class T>
  void fill(const char* label, std::int64_t count, const Body& body, DeviceList<T>& list) {
    list.clear();
    set_size(list, count);
    exec_.for_each(label, count, ListFillBody<Body, T>{body, list.values()});
  }
  void wait() const { check_cuda(cudaStreamSynchronize(exec_.stream()), "cudaStreamSynchronize"); }
  void sort_pairs(const char* label, DeviceList<CellPair>& list, int key_bits) {
    exec_.sort_pairs(label, list.values_.view(list.size_), {}, key_bits);
  }

 private:
  template <class T>
  static void set_size(DeviceList<T>& list, std::int64_t size) {
    list.size_ = size;
    if (size <= list.capacity_) return;
    list.capacity_ = size + size / 2;
    list.values_.reserve(list.capacity_);
  }

  CudaExec exec_;
  DeviceVector<std::int64_t> sums_, totals_;
};

}  // namespace tetwarp

/// @file device_list.cuh
/// A list in memory of a device that a stage appends to, and the ops that append.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"
#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// See CudaExec::append(). Memory is kept when it is cleared.
template <class T>
class DeviceList {
 public:
  std::int64_t size() const { return size_; }
  View<const T> view() const { return values_.const_view(size_); }
  View<T> values() { return values_.view(size_); }
  std::int64_t tally() const { return tally_; }
  void clear() { size_ = tally_ = 0; }

 private:
  friend class CudaExec;

  void set_size(std::int64_t size) {
    size_ = size;
    if (size <= capacity_) return;
    capacity_ = size + size / 2;
    values_.reserve(capacity_);
  }

  DeviceBuffer<T> values_;
  std::int64_t capacity_ = 0, size_ = 0, tally_ = 0;
};

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

/// One index = one index of the op.
template <class Op>
struct AppendCountOp {
  static constexpr int resident_blocks = 1;  ///< else registers of some ops are spilled

  Op op;
  View<std::int64_t> counts, tallies;  ///< out
  __device__ void operator()(std::int64_t i) const {
    CountingEmit emit;
    op(i, emit);
    counts[i] = emit.values;
    tallies[i] = emit.tallied;
  }
};
/// Reads two ends of the sums of what indices append.
struct AppendTotalsOp {
  View<const std::int64_t> sums;  ///< exclusive, of the counts and then of the tallies
  View<std::int64_t> totals;      ///< out [2] number of values, tally

  __device__ void operator()(std::int64_t) const {
    const std::int64_t count = sums.size / 2;
    totals[0] = sums[count];
    totals[1] = sums[2 * count] - sums[count];
  }
};
template <class Op, class T>
struct AppendWriteOp {
  static constexpr int resident_blocks = 1;  ///< else registers of some ops are spilled

  Op op;
  View<const std::int64_t> first;
  View<T> values;  ///< out
  __device__ void operator()(std::int64_t i) const {
    WritingEmit<T> emit{values.data + first[i]};
    op(i, emit);
  }
};

/// Writes the value of one index.
template <class Op, class T>
struct ListFillOp {
  Op op;
  View<T> values;  ///< out
  __device__ void operator()(std::int64_t i) const { values[i] = op(i); }
};

}  // namespace tetwarp

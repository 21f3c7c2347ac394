/// @file host_list.hpp
/// A list in memory of the host that a stage appends to.
#pragma once
#include <cstdint>
#include <vector>

#include "host/exec/host_buffer.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// See CpuExec::append(). Memory is kept when it is cleared.
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
  friend class CpuExec;

  /// What the indices of one task append.
  struct Part {
    std::vector<T> values;
    std::int64_t tallied = 0, first = 0;

    void operator()(const T& value) { values.push_back(value); }
    void tally(std::int64_t count) { tallied += count; }
  };

  void set_size(std::int64_t size) {
    size_ = size;
    if (size > values_.capacity()) values_.reserve(size + size / 2);
  }

  HostBuffer<T> values_;
  std::int64_t size_ = 0, tally_ = 0;
  std::vector<Part> parts_;
};

}  // namespace tetwarp

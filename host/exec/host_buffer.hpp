/// @file host_buffer.hpp
/// Uninitialized memory of the host.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>

#include "kernels/base/view.hpp"

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

}  // namespace tetwarp

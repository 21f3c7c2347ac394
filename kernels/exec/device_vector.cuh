/// @file device_vector.cuh
/// An array with a size in memory of a device.
#pragma once
#include <cstdint>

#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// A vector in memory of a device.
template <class T>
class DeviceVector {
 public:
  void resize(std::int64_t size) {
    buffer_.reserve(size);
    size_ = size;
  }
  View<T> view() { return buffer_.view(size_); }
  View<const T> view() const { return buffer_.const_view(size_); }

 private:
  DeviceBuffer<T> buffer_;
  std::int64_t size_ = 0;
};

template <class T>
View<T> view_of(DeviceVector<T>& values) {
  return values.view();
}
template <class T>
View<const T> view_of(const DeviceVector<T>& values) {
  return values.view();
}
template <class T>
View<const T> const_view(const DeviceVector<T>& values) {
  return values.view();
}

}  // namespace tetwarp

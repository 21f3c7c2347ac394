/// @file exec_buffer.cuh
/// Device memory and page-locked host memory.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <tetwarp/error.hpp>
#include <utility>

#include "kernels/base/view.hpp"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

/// @throws CudaError naming `call` if `error` is one
inline void check_cuda(cudaError_t error, const char* call) {
  if (error != cudaSuccess) {
    cudaGetLastError();  // the runtime keeps the error for the next caller that asks; reported here
    throw CudaError(std::string(call) + ": " + cudaGetErrorString(error));
  }
}

struct DeviceMemory {
  template <class T>
  static void allocate(T** data, std::size_t bytes) {
    check_cuda(cudaMalloc(data, bytes), "cudaMalloc");
  }
  static cudaError_t release(void* data) { return cudaFree(data); }
};

struct PinnedMemory {
  template <class T>
  static void allocate(T** data, std::size_t bytes) {
    check_cuda(cudaMallocHost(data, bytes), "cudaMallocHost");
  }
  static cudaError_t release(void* data) { return cudaFreeHost(data); }
};

/// Owns an array whose capacity never shrinks; contents are undefined after reserve() grew it.
template <class T, class Kind>
class GrowingBuffer {
 public:
  GrowingBuffer() = default;
  GrowingBuffer(GrowingBuffer&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), capacity_(std::exchange(other.capacity_, 0)) {}
  GrowingBuffer& operator=(GrowingBuffer&&) = delete;
  ~GrowingBuffer() { Kind::release(data_); }

  void reserve(std::int64_t size) {
    if (size <= capacity_) return;
    check_cuda(Kind::release(data_), "release of a buffer");
    data_ = nullptr;
    capacity_ = 0;
    Kind::allocate(&data_, static_cast<std::size_t>(size) * sizeof(T));
    capacity_ = size;
  }
  View<T> view(std::int64_t size) const { return {data_, size}; }
  View<const T> const_view(std::int64_t size) const { return {data_, size}; }

 private:
  T* data_ = nullptr;
  std::int64_t capacity_ = 0;
};

template <class T>
using DeviceBuffer = GrowingBuffer<T, DeviceMemory>;
template <class T>
using PinnedBuffer = GrowingBuffer<T, PinnedMemory>;

}  // namespace tetwarp

/// @file device_array.hpp
/// Arrays in memory of a device, emulated or real, for tests of callers that own such memory.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp::test {

/// A copy of a host array on the current device.
class DeviceArray {
 public:
  explicit DeviceArray(std::size_t size) : size_(size) {
    if (size > 0) check_cuda(cudaMalloc(&data_, size * sizeof(double)), "cudaMalloc");
  }
  explicit DeviceArray(const std::vector<double>& values) : DeviceArray(values.size()) {
    set(values);
  }
  DeviceArray(DeviceArray&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  DeviceArray& operator=(DeviceArray&&) = delete;
  ~DeviceArray() { cudaFree(data_); }

  void set(const std::vector<double>& values) {
    if (values.empty()) return;
    check_cuda(cudaMemcpyAsync(data_, values.data(), values.size() * sizeof(double),
                               cudaMemcpyHostToDevice, nullptr),
               "cudaMemcpyAsync to device");
    check_cuda(cudaStreamSynchronize(nullptr), "cudaStreamSynchronize");
  }
  std::vector<double> get() const {
    std::vector<double> values(size_);
    if (size_ == 0) return values;
    check_cuda(cudaMemcpyAsync(values.data(), data_, size_ * sizeof(double), cudaMemcpyDeviceToHost,
                               nullptr),
               "cudaMemcpyAsync to host");
    check_cuda(cudaStreamSynchronize(nullptr), "cudaStreamSynchronize");
    return values;
  }
  double* data() const { return data_; }
  std::span<const double> span() const { return {data_, size_}; }
  std::span<double> target() const { return {data_, size_}; }

 private:
  double* data_ = nullptr;
  std::size_t size_;
};

}  // namespace tetwarp::test

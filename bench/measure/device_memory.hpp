/// @file device_memory.hpp
/// Arrays in memory of a CUDA device, for rows whose steps stay there.
#pragma once
#include <cstddef>

namespace tetwarp::bench {

/// Owns bytes in memory of device 0.
class DeviceMemory {
 public:
  /// @throws CudaError
  explicit DeviceMemory(std::size_t bytes);
  ~DeviceMemory();  // NOLINT(performance-trivially-destructible): not trivial with CUDA
  DeviceMemory(const DeviceMemory&) = delete;
  DeviceMemory& operator=(const DeviceMemory&) = delete;

  void* data() const { return data_; }
  /// Copies all bytes; waits for all work of the device. @throws CudaError
  void put(const void* host) const;
  void get(void* host) const;

 private:
  std::size_t bytes_;
  void* data_ = nullptr;
};

}  // namespace tetwarp::bench

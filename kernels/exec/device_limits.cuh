/// @file device_limits.cuh
/// Limits of a device that decide how work is divided.
#pragma once
#include <cstdint>

#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// What a device offers.
struct DeviceLimits {
  std::int64_t shared_bytes = 0;  ///< of a block, if it asks for them
  std::int64_t multiprocessors = 0;
  bool is_cooperative = false;  ///< a launch can synchronize its whole grid
};

inline DeviceLimits device_limits(int device) {
  const auto value_of = [&](cudaDeviceAttr attribute) {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, attribute, device), "cudaDeviceGetAttribute");
    return value;
  };
  return {value_of(cudaDevAttrMaxSharedMemoryPerBlockOptin),
          value_of(cudaDevAttrMultiProcessorCount), value_of(cudaDevAttrCooperativeLaunch) != 0};
}

}  // namespace tetwarp

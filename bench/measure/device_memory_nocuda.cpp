/// @file device_memory_nocuda.cpp
/// A build without CUDA registers no rows that use device memory.
#include <tetwarp/error.hpp>

#include "bench/measure/device_memory.hpp"

namespace tetwarp::bench {

DeviceMemory::DeviceMemory(std::size_t bytes) : bytes_(bytes) {
  throw CudaError("this build has no CUDA");
}

DeviceMemory::~DeviceMemory() = default;
void DeviceMemory::put(const void*) const {}
void DeviceMemory::get(void*) const {}

}  // namespace tetwarp::bench

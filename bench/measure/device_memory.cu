/// @file device_memory.cu
#include <cuda_runtime.h>

#include "bench/measure/device_memory.hpp"
#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp::bench {

DeviceMemory::DeviceMemory(std::size_t bytes) : bytes_(bytes) {
  check_cuda(cudaSetDevice(0), "cudaSetDevice");
  check_cuda(cudaMalloc(&data_, bytes), "cudaMalloc");
}

DeviceMemory::~DeviceMemory() {
  cudaFree(data_);
}

void DeviceMemory::put(const void* host) const {
  check_cuda(cudaMemcpy(data_, host, bytes_, cudaMemcpyHostToDevice), "cudaMemcpy");
}

void DeviceMemory::get(void* host) const {
  check_cuda(cudaDeviceSynchronize(), "cudaDeviceSynchronize");
  check_cuda(cudaMemcpy(host, data_, bytes_, cudaMemcpyDeviceToHost), "cudaMemcpy");
}

}  // namespace tetwarp::bench

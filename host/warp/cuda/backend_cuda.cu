/// @file backend_cuda.cu
/// Back end cuda: device queries, and the pipeline on a device.
#include "host/warp/cuda/cell_raster_cuda.cuh"

namespace tetwarp {

BackendStatus cuda_status(int device) {
  BackendStatus status{Backend::cuda, false, "", ""};
  int count = 0;
  cudaError_t error = cudaGetDeviceCount(&count);
  if (error == cudaSuccess && (device < 0 || device >= count)) {
    status.reason = "no device " + std::to_string(device) + ", there are " + std::to_string(count);
    return status;
  }
  cudaDeviceProp properties;
  if (error == cudaSuccess) error = cudaGetDeviceProperties(&properties, device);
  if (error != cudaSuccess) {
    cudaGetLastError();  // leaves no error behind for the next call
    status.reason = cudaGetErrorString(error);
    return status;
  }
  status.usable = true;
  status.device = properties.name;
  return status;
}

double free_device_memory(int device) {
  std::size_t free = 0, all = 0;
  if (cudaSetDevice(device) != cudaSuccess || cudaMemGetInfo(&free, &all) != cudaSuccess) {
    cudaGetLastError();  // leaves no error behind for the next call
    return 0;
  }
  return static_cast<double>(free);
}

bool cuda_lock_pages(void* data, std::size_t bytes) {
  if (cudaHostRegister(data, bytes, cudaHostRegisterPortable) == cudaSuccess) return true;
  cudaGetLastError();  // leaves no error behind for the next call
  return false;
}

void cuda_unlock_pages(void* data) {
  cudaHostUnregister(data);
}

std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan& plan) {
  return std::make_unique<WarpPipeline<CudaExec>>(plan, CudaExec(plan.options.device));
}

}  // namespace tetwarp

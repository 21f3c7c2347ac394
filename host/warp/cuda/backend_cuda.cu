/// @file backend_cuda.cu
/// Back end cuda: device queries, and the pipeline on a device.
#include <algorithm>

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

/// No kernel has a larger stack per thread; `./dev check cuda` compares. The first launch of a
/// kernel reserves its stack for as many threads as the device can hold.
constexpr double stack_bytes = 9216;

double free_device_memory(int device) {
  std::size_t free = 0, all = 0;
  cudaDeviceProp properties;
  try {
    const DeviceScope scope(device);
    check_cuda(cudaMemGetInfo(&free, &all), "cudaMemGetInfo");
    check_cuda(cudaGetDeviceProperties(&properties, device), "cudaGetDeviceProperties");
  } catch (const CudaError&) {
    return 0;
  }
  const double threads =
      static_cast<double>(properties.maxThreadsPerMultiProcessor) * properties.multiProcessorCount;
  return std::max(0.0, static_cast<double>(free) - threads * stack_bytes);
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
  const DeviceScope scope(plan.options.device);
  const StageClocks clocks = plan.options.stage_times ? StageClocks::on : StageClocks::off;
  return std::make_unique<WarpPipeline<CudaExec>>(plan, CudaExec(plan.options.device, clocks));
}

}  // namespace tetwarp

/// @file emulated_backend.cpp
/// Back end cuda on the emulated device: executor, pipeline and kernels are those of the real one.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <numeric>

#include "host/base/warp_backend.hpp"
#include "host/warp/point_run.hpp"

#include "host/warp/cuda/cell_raster_cuda.cuh"

namespace tetwarp {
BackendStatus cuda_status(int device) {
  if (device == 0) return {Backend::cuda, true, "emulation", ""};
  return {Backend::cuda, false, "", "no device " + std::to_string(device) + ", there are 1"};
}

double free_device_memory(int device) {
  return device == 0 ? 0x1p40 : 0;
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

void move_points_cuda(const PointPlan& plan, MappedPoints& result) {
  const DeviceScope scope(plan.device);
  CudaExec exec(plan.device, StageClocks::off);
  move_points(exec, plan, result);
}

}  // namespace tetwarp

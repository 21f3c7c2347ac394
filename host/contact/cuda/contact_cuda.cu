/// @file contact_cuda.cu
/// The stages of contact on a CUDA device, for ContactSolver.
// Stages are host-device functions templated on the executor; nvcc warns of the executors whose
// members run on one side only.
#pragma nv_diag_suppress 20011, 20014
#include "host/base/warp_backend.hpp"
#include "host/contact/cuda/contact_cuda.cuh"

namespace tetwarp {

std::unique_ptr<ContactDevice> make_contact_device(int device) {
  const BackendStatus status = cuda_status(device);
  if (!status.usable)
    throw CudaError("cuda device " + std::to_string(device) + ": " + status.reason);
  const DeviceScope scope(device);
  return std::make_unique<CudaContactDevice>(device, status.device);
}

}  // namespace tetwarp

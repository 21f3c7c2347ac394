/// @file detector_cuda.cu
// Stages are host-device functions templated on the executor; nvcc warns of the executors whose
// members run on one side only.
#pragma nv_diag_suppress 20011, 20013, 20014, 20015
#include "host/base/warp_backend.hpp"
#include "host/collide/exec_detector.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

std::unique_ptr<Detector> make_cuda_detector(const CollisionSurfaces& surfaces,
                                             const DetectorOptions& options) {
  const BackendStatus status = cuda_status(options.device);
  if (!status.usable) {
    throw CudaError("cuda device " + std::to_string(options.device) + ": " + status.reason);
  }
  const DeviceScope scope(options.device);
  return std::make_unique<ExecDetector<CudaExec>>(CudaExec(options.device, StageClocks::off),
                                                  surfaces, options);
}

}  // namespace tetwarp

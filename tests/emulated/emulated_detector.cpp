/// @file emulated_detector.cpp
/// The detector of back end cuda on the emulated device, with the executor and kernels of the real
/// one.
#include "host/collide/exec_detector.hpp"
#include "kernels/exec/exec_cuda.cuh"

namespace tetwarp {

std::unique_ptr<Detector> make_cuda_detector(const CollisionSurfaces& surfaces,
                                             const DetectorOptions& options) {
  if (options.device != 0) throw CudaError("there is one emulated device");
  return std::make_unique<ExecDetector<CudaExec>>(CudaExec(0, StageClocks::off), surfaces, options);
}

}  // namespace tetwarp

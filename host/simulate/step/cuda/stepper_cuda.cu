/// @file stepper_cuda.cu
/// The stages of a step of bodies on a CUDA device, as a BodyStepper.
// Stages are host-device functions templated on the executor; nvcc warns of the executors whose
// members run on one side only.
#pragma nv_diag_suppress 20011, 20013, 20014, 20015
#include "host/base/warp_backend.hpp"
#include "host/simulate/step/cuda/stepper_cuda.cuh"

namespace tetwarp {

std::unique_ptr<BodyStepper> make_cuda_stepper(const Model& model, const StepperOptions& options) {
  const BackendStatus status = cuda_status(options.device);
  if (!status.usable) {
    throw CudaError("cuda device " + std::to_string(options.device) + ": " + status.reason);
  }
  return make_stepper_on_device(model, options, status.device);
}

}  // namespace tetwarp

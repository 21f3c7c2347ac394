/// @file emulated_stepper.cpp
/// The stepper of back end cuda on the emulated device, with the executor and kernels of the real
/// one.
#include "host/simulate/step/cuda/stepper_cuda.cuh"

namespace tetwarp {

std::unique_ptr<BodyStepper> make_cuda_stepper(const Model& model, const StepperOptions& options) {
  if (options.device != 0) throw CudaError("there is one emulated device");
  return make_stepper_on_device(model, options, "emulation");
}

}  // namespace tetwarp

/// @file stepper_nocuda.cpp
/// make_cuda_stepper() of a build without CUDA: always throws.
#include <tetwarp/error.hpp>

#include "host/simulate/step/stepper.hpp"

namespace tetwarp {

std::unique_ptr<BodyStepper> make_cuda_stepper(const Model&, const StepperOptions&) {
  throw CudaError("this build has no CUDA; build with the CUDA toolkit installed");
}

}  // namespace tetwarp

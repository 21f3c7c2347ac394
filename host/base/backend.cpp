/// @file backend.cpp
/// Which back ends this build and machine have, and which of them a choice means.
#include <string>
#include <tetwarp/backend.hpp>
#include <tetwarp/error.hpp>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

std::vector<BackendStatus> available_backends(int device) {
  const std::string processor = processor_name();
  return {cuda_status(device),
          {Backend::cpu, true, processor, ""},
          {Backend::reference, true, processor, ""}};
}

std::pair<Backend, std::string> choose_backend(Backend requested, int device) {
  if (requested == Backend::cpu || requested == Backend::reference) return {requested, "requested"};
  const BackendStatus cuda = cuda_status(device);
  if (cuda.usable) {
    return {Backend::cuda, requested == Backend::cuda ? "requested" : cuda.device + " is usable"};
  }
  if (requested == Backend::cuda) {
    throw CudaError("back end cuda: " + cuda.reason + "; use cpu or auto");
  }
  return {Backend::cpu, "no usable CUDA device (" + cuda.reason + ")"};
}

}  // namespace tetwarp

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

std::pair<Backend, std::string> choose_backend(Backend asked, int device) {
  if (asked == Backend::cpu || asked == Backend::reference) return {asked, "asked for"};
  const BackendStatus cuda = cuda_status(device);
  if (cuda.usable) {
    return {Backend::cuda, asked == Backend::cuda ? "asked for" : cuda.device + " answers"};
  }
  if (asked == Backend::cuda) {
    throw CudaError("back end cuda: " + cuda.reason + "; use cpu or auto");
  }
  return {Backend::cpu, "no CUDA device answers (" + cuda.reason + ")"};
}

}  // namespace tetwarp

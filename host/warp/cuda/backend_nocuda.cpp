/// @file backend_nocuda.cpp
/// Back end cuda of a build without the CUDA toolkit: never usable.
#include <tetwarp/error.hpp>

#include "host/base/warp_backend.hpp"

namespace tetwarp {
namespace {
constexpr const char* reason = "this build has no CUDA; build with the CUDA toolkit installed";
}

BackendStatus cuda_status(int) {
  return {Backend::cuda, false, "", reason};
}

double free_device_memory(int) {
  return 0;
}

bool cuda_lock_pages(void*, std::size_t) {
  return false;
}

void cuda_unlock_pages(void*) {}

std::unique_ptr<WarpBackend> make_cuda_backend(const WarpPlan&) {
  throw CudaError(reason);
}

}  // namespace tetwarp

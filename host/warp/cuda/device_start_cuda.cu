/// @file device_start_cuda.cu
/// Whether this process has started a device.
#include <dlfcn.h>

#include "host/warp/device_start.hpp"

namespace tetwarp {

double cuda_start_seconds(int device) {
  // Only a driver that the process has loaded can have a context; asking the runtime would load it.
  void* const driver = dlopen("libcuda.so.1", RTLD_LAZY | RTLD_NOLOAD);
  if (driver == nullptr) return device_start_seconds;
  using GetState = int (*)(int device, unsigned* flags, int* active);
  const auto get_state = reinterpret_cast<GetState>(dlsym(driver, "cuDevicePrimaryCtxGetState"));
  unsigned flags = 0;
  int active = 0;
  const bool is_known = get_state != nullptr && get_state(device, &flags, &active) == 0;
  dlclose(driver);
  return is_known && active != 0 ? 0 : device_start_seconds;
}

}  // namespace tetwarp

/// @file device_start_nocuda.cpp
/// A build without CUDA never starts a device.
#include "host/warp/device_start.hpp"

namespace tetwarp {

double cuda_start_seconds(int) {
  return 0;
}

}  // namespace tetwarp

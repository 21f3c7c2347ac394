/// @file emulated_start.cpp
/// The emulated device has started while memory of it is in use.
#include "host/warp/device_start.hpp"
#include "kernels/exec/launch.hpp"

namespace tetwarp {

double cuda_start_seconds(int) {
  return simt::Device::only().allocated() > 0 ? 0 : device_start_seconds;
}

}  // namespace tetwarp

/// @file emulated_contact.cpp
/// The contact solver's device on the emulated one, with the executors and kernels of the real one.
#include "host/contact/cuda/contact_cuda.cuh"

namespace tetwarp {

std::unique_ptr<ContactDevice> make_contact_device(int device) {
  if (device != 0) throw CudaError("no device " + std::to_string(device) + ", there are 1");
  const DeviceScope scope(device);
  return std::make_unique<CudaContactDevice>(device, "emulation");
}

}  // namespace tetwarp

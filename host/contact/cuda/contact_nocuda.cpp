/// @file contact_nocuda.cpp
/// The contact solver's device in a build without the CUDA toolkit: it says so.
#include <tetwarp/error.hpp>

#include "host/contact/cuda/device.hpp"

namespace tetwarp {

std::unique_ptr<ContactDevice> make_contact_device(int) {
  throw CudaError("this build has no CUDA; build with the CUDA toolkit installed");
}

}  // namespace tetwarp

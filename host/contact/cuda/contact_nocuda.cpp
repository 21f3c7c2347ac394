/// @file contact_nocuda.cpp
/// make_contact_device() of a build without CUDA: always throws.
#include <tetwarp/error.hpp>

#include "host/contact/cuda/device.hpp"

namespace tetwarp {

std::unique_ptr<ContactDevice> make_contact_device(int) {
  throw CudaError("this build has no CUDA; build with the CUDA toolkit installed");
}

}  // namespace tetwarp

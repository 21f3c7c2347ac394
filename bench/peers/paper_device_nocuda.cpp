/// @file paper_device_nocuda.cpp
/// A build without the CUDA toolkit has no rows of a device.
#include <tetwarp/error.hpp>

#include "bench/peers/paper_device.hpp"

namespace tetwarp::bench {

PaperDeviceSteps paper_method_on_device(const PeerInput&, bool) {
  throw CudaError("this build has no CUDA");
}

}  // namespace tetwarp::bench

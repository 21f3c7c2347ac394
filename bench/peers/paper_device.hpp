/// @file paper_device.hpp
/// The method of Gascon et al. 2013 on a device, for programs without CUDA's headers.
#pragma once
#include <functional>

#include "bench/peers/peer.hpp"

namespace tetwarp::bench {

/// Steps that stay in memory of device 0.
struct PaperDeviceSteps {
  PeerStep step;                ///< waits for the device
  std::function<void()> fetch;  ///< copies the output of the last step to PeerInput::output
};

/// As paper_method(), with kernels. @throws CudaError
PaperDeviceSteps paper_method_on_device(const PeerInput& input, bool with_cells);

}  // namespace tetwarp::bench

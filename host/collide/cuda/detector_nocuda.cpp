/// @file detector_nocuda.cpp
/// make_cuda_detector() of a build without CUDA: always throws.
#include <tetwarp/error.hpp>

#include "host/collide/detector.hpp"

namespace tetwarp {

std::unique_ptr<Detector> make_cuda_detector(const CollisionSurfaces&, const DetectorOptions&) {
  throw CudaError("this build has no CUDA; build with the CUDA toolkit installed");
}

}  // namespace tetwarp

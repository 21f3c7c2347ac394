/// @file device_floors_nocuda.cpp
/// A build without CUDA registers no rows that call these functions.
#include <tetwarp/error.hpp>

#include "bench/measure/device_floors.hpp"

namespace tetwarp::bench {

DeviceFloor measure_device_floor(const AffineJob&, int) {
  throw CudaError("this build has no CUDA");
}

double device_copy_bandwidth(int) {
  throw CudaError("this build has no CUDA");
}

}  // namespace tetwarp::bench

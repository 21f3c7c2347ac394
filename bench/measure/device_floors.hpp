/// @file device_floors.hpp
/// Lower bounds of a warp's time on a CUDA device.
#pragma once
#include <string>

#include "bench/measure/floors.hpp"

namespace tetwarp::bench {

/// The sampling floor of a device, medians of nine [s].
struct DeviceFloor {
  double kernel = 0;       ///< source and output resident
  double with_copies = 0;  ///< the same with a copy of the output to pinned host memory
  std::string layout;      ///< fastest layout of the source (linear, bricked, array) and tile
};

/// Samples the job by the fastest of three source layouts and two tile shapes. float64 has no
/// array layout; all are computed in float32. The arrangement of the source is not timed.
/// @throws CudaError
DeviceFloor measure_device_floor(const AffineJob& job, int device);

/// Bytes read plus bytes written per second by a copy of 1 GiB on the device, best of nine.
/// @throws CudaError
double device_copy_bandwidth(int device);

}  // namespace tetwarp::bench

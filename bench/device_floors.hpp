/// @file device_floors.hpp
/// What no warp can beat on a CUDA device.
#pragma once
#include <string>

#include "bench/floors.hpp"

namespace tetwarp::bench {

/// The sampling floor of a device, medians of nine [s].
struct DeviceFloor {
  double kernel = 0;       ///< source and output resident
  double with_copies = 0;  ///< and the output brought home to pinned memory
  std::string layout;      ///< of the source, the fastest: linear, bricked or array; and the tile
};

/// Samples the job by the fastest of three source layouts and two tile shapes. float64 has no
/// array layout; all are computed in float32. The arrangement of the source is not timed.
/// @throws CudaError
DeviceFloor measure_device_floor(const AffineJob& job, int device);

/// Bytes read plus bytes written per second by a copy of 1 GiB on the device, best of nine.
/// @throws CudaError
double device_copy_bandwidth(int device);

}  // namespace tetwarp::bench

/// @file device_start.hpp
/// What the first use of a CUDA device costs.
#pragma once

namespace tetwarp {

/// Between 0.1 and 0.3 s on an NVIDIA H200: driver, context, modules.
constexpr double device_start_seconds = 0.2;

/// What the first use of a CUDA device takes from now on [s], without using it: 0 when this process
/// has already started it, here or in another library, and in a build without CUDA.
double cuda_start_seconds(int device);

}  // namespace tetwarp

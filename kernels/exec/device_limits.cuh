/// @file device_limits.cuh
/// Limits of a device that decide how work is divided.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/exec/exec_buffer.cuh"

namespace tetwarp {

/// What a device offers.
struct DeviceLimits {
  std::int64_t shared_bytes = 0;  ///< of a block, if it asks for them
  std::int64_t multiprocessors = 0;
  bool is_cooperative = false;  ///< a launch can synchronize its whole grid
};

inline DeviceLimits device_limits(int device) {
  const auto value_of = [&](cudaDeviceAttr attribute) {
    int value = 0;
    check_cuda(cudaDeviceGetAttribute(&value, attribute, device), "cudaDeviceGetAttribute");
    return value;
  };
  return {value_of(cudaDevAttrMaxSharedMemoryPerBlockOptin),
          value_of(cudaDevAttrMultiProcessorCount), value_of(cudaDevAttrCooperativeLaunch) != 0};
}

/// Time of an iteration of one island [s].
struct TeamTimes {
  double block, grid;  ///< by one block; by a grid on the whole device
};

/// How many islands a grid solves, one after the other and before the others, which one block each
/// solves, all at once: so that an iteration of all of them is the shortest.
/// @param islands  by falling time of a block
inline std::size_t count_by_grid(const std::vector<TeamTimes>& islands,
                                 std::int64_t multiprocessors) {
  std::size_t best = 0;
  double least = 0, by_grid = 0;
  for (std::size_t n = 0; n <= islands.size(); ++n) {
    const auto others = static_cast<std::int64_t>(islands.size() - n);
    const std::int64_t waves = (others + multiprocessors - 1) / multiprocessors;
    const double by_blocks = others == 0 ? 0 : static_cast<double>(waves) * islands[n].block;
    if (n == 0 || by_grid + by_blocks < least) {
      best = n;
      least = by_grid + by_blocks;
    }
    if (n < islands.size()) by_grid += islands[n].grid;
  }
  return best;
}

}  // namespace tetwarp

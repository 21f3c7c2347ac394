/// @file backend.hpp
/// The back ends, and which of them are usable on this machine.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/names.hpp>

namespace tetwarp {

/// Where a computation runs.
enum class Backend {
  automatic,  ///< warps: cuda when a device is usable, else cpu; contact: cpu, until contact has
              ///< been measured on a device
  cuda,       ///< a CUDA device
  cpu,        ///< threads and vector instructions of the host
  reference   ///< warps and contact straight from the definitions, float64, one thread: slow, for
              ///< verification
};

/// One back end on this machine.
struct BackendStatus {
  Backend backend = Backend::cpu;
  bool usable = false;
  std::string device;  ///< name of the device or processor; empty when not usable
  std::string reason;  ///< why it is not usable, in the words of the CUDA runtime; else empty
};

/// Status of cuda, cpu and reference, in that order.
/// @param device  CUDA device number
TETWARP_EXPORT std::vector<BackendStatus> available_backends(int device = 0);

/// The back end that a warp uses for a choice of WarpOptions::backend.
/// @param requested  the choice
/// @param device  CUDA device number
/// @returns cuda, cpu or reference, and the reason in one sentence
/// @throws CudaError when `requested` is cuda and the device is not usable
TETWARP_EXPORT std::pair<Backend, std::string> choose_backend(Backend requested, int device = 0);

}  // namespace tetwarp

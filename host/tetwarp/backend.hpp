/// @file backend.hpp
/// The back ends, and which of them answer on this machine.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/names.hpp>

namespace tetwarp {

/// Where a computation runs. `automatic` means, for a warp, cuda when a device is usable, else cpu
/// (choose_backend()); for contact it means cpu (choose_contact_backend() in contact.hpp).
enum class Backend { automatic, cuda, cpu, reference };

/// One back end on this machine.
struct BackendStatus {
  Backend backend = Backend::cpu;
  bool usable = false;
  std::string device;  ///< device or processor name, empty when not usable
  std::string reason;  ///< why it is not usable, in the runtime's own words
};

/// Status of cuda (on device number `device`), cpu and reference, in that order. Never throws.
TETWARP_EXPORT std::vector<BackendStatus> available_backends(int device = 0);

/// The back end that a warp runs on that asks for this one, and why, in one sentence.
/// @throws CudaError when cuda is asked for and does not answer
TETWARP_EXPORT std::pair<Backend, std::string> choose_backend(Backend asked, int device = 0);

}  // namespace tetwarp

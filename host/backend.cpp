/// @file backend.cpp
#include <tetwarp/backend.hpp>

#include "host/warp_backend.hpp"

namespace tetwarp {

const char* name_of(Backend backend) {
  static constexpr const char* names[] = {"auto", "cuda", "cpu", "reference"};
  return names[static_cast<int>(backend)];
}

std::vector<BackendStatus> available_backends(int device) {
  const std::string processor = processor_name();
  return {cuda_status(device),
          {Backend::cpu, true, processor, ""},
          {Backend::reference, true, processor, ""}};
}

}  // namespace tetwarp

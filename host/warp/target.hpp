/// @file target.hpp
/// The arrays of a target as one list: the volumes, then those of extra_outputs.hpp in its order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/extra_outputs.hpp"
#include "host/base/warp_backend.hpp"

namespace tetwarp {

/// Null: not written.
inline std::vector<void*> arrays_of(const WarpTarget& target) {
  std::vector<void*> arrays(target.volumes.begin(), target.volumes.end());
  for (const ExtraOutput& extra : extra_outputs) arrays.push_back(extra.get(target));
  return arrays;
}

/// Bytes per voxel of each array.
inline std::vector<std::int64_t> voxel_bytes_of(const std::vector<VolumeView>& sources) {
  std::vector<std::int64_t> bytes;
  bytes.reserve(sources.size() + extra_outputs.size());
  for (const VolumeView& source : sources) {
    bytes.push_back(source.components * static_cast<std::int64_t>(size_of(source.type)));
  }
  for (const ExtraOutput& extra : extra_outputs) bytes.push_back(extra.voxel_bytes());
  return bytes;
}

/// True when a field is to be computed from the owner of every output voxel.
inline bool needs_owners(const FieldTarget& fields) {
  return fields.displacement != nullptr || fields.jacobian != nullptr ||
         fields.gradient != nullptr || fields.strain != nullptr;
}

}  // namespace tetwarp

/// @file target.hpp
/// The arrays of a target as one list, for what is done to each alike.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host/base/warp_backend.hpp"

namespace tetwarp {

/// Places in the list, behind the volumes.
enum class Extra : std::size_t { mask, tet, displacement, jacobian, gradient, strain, forward };

/// Volumes, then the others in the order of Extra; null: not wanted.
inline std::vector<void*> arrays_of(const WarpTarget& target) {
  const FieldTarget& fields = target.fields;
  std::vector<void*> arrays(target.volumes.begin(), target.volumes.end());
  for (void* const extra :
       {static_cast<void*>(target.mask), static_cast<void*>(target.owner),
        static_cast<void*>(fields.displacement), static_cast<void*>(fields.jacobian),
        static_cast<void*>(fields.gradient), static_cast<void*>(fields.strain),
        static_cast<void*>(fields.forward)}) {
    arrays.push_back(extra);
  }
  return arrays;
}

/// Bytes per voxel of each.
inline std::vector<std::int64_t> voxel_bytes_of(const std::vector<VolumeView>& sources) {
  constexpr std::int64_t real = sizeof(float);
  std::vector<std::int64_t> bytes;
  for (const VolumeView& source : sources) {
    bytes.push_back(source.components * static_cast<std::int64_t>(size_of(source.type)));
  }
  bytes.insert(bytes.end(),
               {1, sizeof(std::int32_t), 3 * real, real, 9 * real, 6 * real, 3 * real});
  return bytes;
}

/// True when a field is wanted that takes the owner of every output voxel.
inline bool needs_owners(const FieldTarget& fields) {
  return fields.displacement != nullptr || fields.jacobian != nullptr ||
         fields.gradient != nullptr || fields.strain != nullptr;
}

}  // namespace tetwarp

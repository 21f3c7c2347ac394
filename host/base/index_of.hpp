/// @file index_of.hpp
/// Signed indices, as arrays of this project hold them, for standard containers.
#pragma once
#include <cstddef>
#include <cstdint>

namespace tetwarp {

/// @pre i >= 0
inline std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

}  // namespace tetwarp

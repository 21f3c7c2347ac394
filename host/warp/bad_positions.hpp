/// @file bad_positions.hpp
/// Errors for meshes beyond the limits: nodes that are not finite or too far away, too many pairs.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "kernels/warp/tet_setup.hpp"

namespace tetwarp {

/// Largest number of (tetrahedron, cell) pairs: CellRange holds 32-bit positions in their list.
constexpr std::int64_t max_pairs = (std::int64_t{1} << 32) - 2;

/// @throws std::invalid_argument above max_pairs
inline void check_pair_count(std::int64_t count) {
  if (count <= max_pairs) return;
  throw std::invalid_argument(
      "mesh: " + std::to_string(count) +
      " pairs of tetrahedron and cell, at most 2^32 - 2 fit; compute regions of the grid");
}

/// True when the counts per TetClass include tetrahedra that cannot be placed in the grid.
inline bool has_bad_positions(const std::int64_t* classes) {
  return classes[static_cast<int>(TetClass::bad_position)] != 0 ||
         classes[static_cast<int>(TetClass::too_large)] != 0;
}

/// @throws std::invalid_argument naming tetrahedron t when it is of a class that cannot be placed
inline void throw_on_bad_position(TetClass tet_class, std::int64_t t) {
  if (tet_class == TetClass::bad_position) {
    throw std::invalid_argument("deformed positions: a node of tetrahedron " + std::to_string(t) +
                                " is not finite or over 2^40 voxels from the output grid");
  }
  if (tet_class == TetClass::too_large) {
    throw std::invalid_argument("deformed positions: tetrahedron " + std::to_string(t) +
                                " spans over 2^20 voxels; use a coarser output grid");
  }
}

/// @throws std::invalid_argument naming the first tetrahedron that cannot be placed
inline void throw_on_bad_positions(std::span<const TetSetup> setups) {
  for (std::size_t t = 0; t < setups.size(); ++t) {
    throw_on_bad_position(setups[t].tet_class, static_cast<std::int64_t>(t));
  }
}

}  // namespace tetwarp

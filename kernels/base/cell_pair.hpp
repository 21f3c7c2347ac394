/// @file cell_pair.hpp
/// A cell of the output and a tetrahedron that may own voxels of it, in one sortable word.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// cell << 32, then accepted << 31, then the tetrahedron. Sorting by the upper half alone, stably,
/// gives the order cell, then tetrahedron.
using CellPair = std::uint64_t;

constexpr CellPair rejected_pair = ~CellPair{0};
constexpr std::uint32_t accepted_bit = 0x80000000u;  ///< every voxel of the cell is inside

TETWARP_HD CellPair make_pair(std::int64_t cell, std::int64_t tet, bool accepted) {
  return static_cast<CellPair>(cell) << 32 | (accepted ? accepted_bit : 0u) |
         static_cast<CellPair>(tet);
}
TETWARP_HD std::int64_t cell_of(CellPair pair) {
  return static_cast<std::int64_t>(pair >> 32);
}
TETWARP_HD int tet_of(CellPair pair) {
  return static_cast<int>(static_cast<std::uint32_t>(pair) & ~accepted_bit);
}
TETWARP_HD bool is_accepted(CellPair pair) {
  return (pair & accepted_bit) != 0;
}

}  // namespace tetwarp

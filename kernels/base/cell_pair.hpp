/// @file cell_pair.hpp
/// A cell of the output and a tetrahedron that may own voxels of it, in one sortable word.
#pragma once
#include <cstdint>

#include "kernels/base/key_value.hpp"

namespace tetwarp {

/// The key is the cell, the value the tetrahedron. The flag is set where the pair is accepted:
/// every voxel of the cell is inside.
using CellPair = KeyValue;

constexpr CellPair rejected_pair = no_key_value;

TETWARP_HD CellPair make_pair(std::int64_t cell, std::int64_t tet, bool accepted) {
  return make_key_value(cell, tet, accepted);
}
TETWARP_HD std::int64_t cell_of(CellPair pair) {
  return key_of(pair);
}
TETWARP_HD int tet_of(CellPair pair) {
  return value_of(pair);
}
TETWARP_HD bool is_accepted(CellPair pair) {
  return flag_of(pair);
}

}  // namespace tetwarp

/// @file hex_view.hpp
/// The hexahedra of a mesh, which is otherwise one of tetrahedra: those it came with, then
/// tets_per_hex for each hexahedron.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

constexpr int tets_per_hex = 6;

/// Nodes of the hexahedra of a mesh, whose tetrahedra come after all others.
struct HexView {
  View<const std::int32_t> nodes;  ///< [8 * hex_count], in VTK's order
  std::int64_t first_tet = 0;      ///< the first tetrahedron that belongs to one

  TETWARP_HD bool has(std::int64_t tet) const { return nodes.size > 0 && tet >= first_tet; }
  /// @pre has(tet)
  TETWARP_HD const std::int32_t* nodes_of(std::int64_t tet) const {
    return nodes.data + 8 * ((tet - first_tet) / tets_per_hex);
  }
  /// Number of the cell that a tetrahedron is or belongs to: tetrahedra first, then hexahedra.
  TETWARP_HD std::int64_t cell_of(std::int64_t tet) const {
    return has(tet) ? first_tet + (tet - first_tet) / tets_per_hex : tet;
  }
};

}  // namespace tetwarp

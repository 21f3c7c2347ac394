/// @file hex_view.hpp
/// Hexahedra of a mesh. Stages work on tetrahedra: each hexahedron is split into tets_per_hex of
/// them, which are numbered after the mesh's own tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/base/view.hpp"

namespace tetwarp {

constexpr int tets_per_hex = 6;

/// Nodes of the hexahedra, and which tetrahedra are their parts.
struct HexView {
  View<const std::int32_t> nodes;  ///< [8 * hex_count], in VTK's order
  std::int64_t first_tet = 0;      ///< first tetrahedron that is part of a hexahedron

  /// Whether a tetrahedron is part of a hexahedron.
  TETWARP_HD bool has(std::int64_t tet) const { return nodes.size > 0 && tet >= first_tet; }
  /// @pre has(tet)
  TETWARP_HD const std::int32_t* nodes_of(std::int64_t tet) const {
    return nodes.data + 8 * ((tet - first_tet) / tets_per_hex);
  }
  /// Index of the mesh element that a tetrahedron is, or is part of. The mesh's own tetrahedra are
  /// numbered first, then its hexahedra.
  TETWARP_HD std::int64_t cell_of(std::int64_t tet) const {
    return has(tet) ? first_tet + (tet - first_tet) / tets_per_hex : tet;
  }
};

}  // namespace tetwarp

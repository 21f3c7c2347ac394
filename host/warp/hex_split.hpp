/// @file hex_split.hpp
/// Hexahedra as tetrahedra, for all that decides who owns a voxel.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/mesh.hpp>

#include "kernels/base/hex_view.hpp"

namespace tetwarp {

/// Splits each hexahedron into tets_per_hex tetrahedra: from the node with the lowest number to the
/// triangles of the three faces that do not hold it. Every face is cut from its own lowest node, so
/// that hexahedra that share it agree.
///
/// Source: the rule of the lowest number is that of J. Dompierre et al., "How to subdivide
/// pyramids, prisms and hexahedra into tetrahedra", 1999.
/// @param hexes  nodes in VTK's order: 0 to 3 around the bottom, 4 to 7 above them
/// @returns [tets_per_hex * hexes.size()], those of a hexahedron side by side
std::vector<std::array<std::int32_t, 4>> split_hexes(
    std::span<const std::array<std::int32_t, 8>> hexes);

/// A mesh whose tetrahedra are followed by those of its hexahedra.
Mesh with_split_hexes(Mesh mesh);

}  // namespace tetwarp

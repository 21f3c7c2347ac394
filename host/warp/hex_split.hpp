/// @file hex_split.hpp
/// Division of hexahedra into tetrahedra, by which voxels are assigned to owners.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <tetwarp/mesh.hpp>

#include "kernels/base/hex_view.hpp"

namespace tetwarp {

/// Splits each hexahedron into tets_per_hex tetrahedra. Each joins the node of the lowest number to
/// one of the six triangles of the faces that do not contain this node. Faces are divided by the
/// diagonal from their own lowest node, so that both hexahedra of a shared face divide it equally.
///
/// Source: the rule of the lowest number is that of J. Dompierre et al., "How to subdivide
/// pyramids, prisms and hexahedra into tetrahedra", 1999.
/// @param hexes  nodes in VTK's order: 0 to 3 around the bottom, 4 to 7 above them
/// @returns [tets_per_hex * hexes.size()], those of a hexahedron in succession
std::vector<std::array<std::int32_t, 4>> split_hexes(
    std::span<const std::array<std::int32_t, 8>> hexes);

/// The mesh with the tetrahedra of its hexahedra appended to its own.
Mesh with_split_hexes(Mesh mesh);

}  // namespace tetwarp

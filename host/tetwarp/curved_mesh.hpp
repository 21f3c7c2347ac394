/// @file curved_mesh.hpp
/// Meshes with tetrahedra of ten nodes, whose edges may be bent.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/mesh.hpp>

namespace tetwarp {

/// The nodes on the edges of a tetrahedron in VTK's order: of the edges between its nodes 0 1, 1 2,
/// 2 0, 0 3, 1 3 and 2 3.
using MidNodes = std::array<std::int32_t, 6>;

constexpr MidNodes no_mid_nodes = {-1, -1, -1, -1, -1, -1};  ///< of a tetrahedron of four nodes

/// A mesh some of whose tetrahedra have ten nodes: between them positions are quadratic, so that
/// edges go through their middle nodes.
///
/// A voxel or point belongs to the tetrahedron whose four corners hold it, as if edges were
/// straight, and is mapped by the quadratic map of that tetrahedron, inverted by Newton's method.
/// Let L be the barycentric coordinates of a place in the straight tetrahedron, and d the way of
/// each middle node from the middle of its edge. The quadratic map moves this place by at most the
/// sum over edges of 4 L_a L_b |d|: within the cell by 1.5 times the longest d, on its faces by 4/3
/// times.
///
/// Where Newton's method does not converge, the quadratic map is folded, the place lies more than a
/// quarter of the cell beyond it, or a middle node is beyond the limits of positions, the straight
/// map is taken and counted (Counts::voxels_straightened, MappedPoints::straightened). A cell all
/// of whose middle nodes are within 2^-20 voxel of the middles of their edges, along each axis, is
/// one of four nodes. Source: the quadratic tetrahedron of finite elements, whose shape functions
/// are L (2 L - 1) at corners and 4 L_a L_b on edges.
struct CurvedMesh {
  Mesh mesh;  ///< its rest positions include the nodes on edges [world]
  /// [tet_count], indices into rest_positions or no_mid_nodes; empty: no tetrahedron has any.
  std::vector<MidNodes> mid_nodes = {};
};

/// Checks that there are middle nodes for each tetrahedron or for none, and that they exist.
/// @param mid_nodes  [tet_count] or empty
/// @throws std::invalid_argument naming the first violation
TETWARP_EXPORT void check_mid_nodes(const Mesh& mesh, const std::vector<MidNodes>& mid_nodes);

/// Whether a tetrahedron has ten nodes.
inline bool is_curved(const CurvedMesh& mesh, std::size_t tet) {
  return tet < mesh.mid_nodes.size() && mesh.mid_nodes[tet] != no_mid_nodes;
}

/// The eight tetrahedra between the ten nodes of one, with its orientation: four at its corners,
/// and four around the line between the middles of two opposite edges.
TETWARP_EXPORT std::array<std::array<std::int32_t, 4>, 8> parts_of_curved(
    const std::array<std::int32_t, 4>& corners, const MidNodes& mid_nodes);

/// The mesh with these in place of every tetrahedron of ten nodes. Its map is off the curved one by
/// at most a quarter of the sum of the distances of the six middle nodes from the middles of their
/// edges [world].
/// @pre check_mid_nodes() has passed
TETWARP_EXPORT Mesh split_curved(const CurvedMesh& mesh);

}  // namespace tetwarp

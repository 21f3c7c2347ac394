/// @file lattice.hpp
/// Lattices of boxes, each divided into five tetrahedra.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host/base/lattice_cells.hpp"

namespace tetwarp {

/// Tetrahedra and their nodes.
struct TetMesh {
  std::vector<Point3> nodes;
  std::vector<std::array<std::int32_t, 4>> tets;
};

/// Volume of a tetrahedron, positive if its nodes are in right-handed order.
double tet_volume(const TetMesh& mesh, const std::array<std::int32_t, 4>& tet);

/// Boxes that fill `bounds` exactly.
LatticeFrame fitted_frame(const Bounds& bounds, const std::array<std::int64_t, 3>& cells);

/// @param place  of the choice of boxes, for messages
/// @throws std::invalid_argument  the tetrahedra are 2^31 or more
void check_cells(const std::string& place, const std::array<double, 3>& cells);

/// The five tetrahedra of each box of a frame, box by box with a fastest. Volumes are positive in
/// the frame. Nodes are numbered with a fastest.
TetMesh make_lattice(const LatticeFrame& frame);

/// Keeps the tetrahedra with is_kept[t] != 0, in order, and the nodes that they use, in order.
/// @returns per node of `mesh` its new number, or -1
std::vector<std::int32_t> keep_tets(TetMesh& mesh, const std::vector<std::uint8_t>& is_kept);

/// Moves nodes to map(node), and reorders the nodes of tetrahedra whose volume then is negative.
void map_nodes(TetMesh& mesh, const std::function<Point3(const Point3&)>& map);

/// Reorders the nodes of tetrahedra of negative volume. @param place  of the mesh, for messages
/// @throws std::invalid_argument  a volume is zero or not finite
void orient_tets(const std::string& place, TetMesh& mesh);

}  // namespace tetwarp

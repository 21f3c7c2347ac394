/// @file mesh.hpp
/// Meshes of tetrahedra, hexahedra or both that embed a volume.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/export.hpp>
#include <tetwarp/volume.hpp>

namespace tetwarp {

/// A mesh in its rest state: node positions, and the nodes of each cell. Cells are numbered
/// tetrahedra first, then hexahedra.
struct Mesh {
  std::vector<Point3> rest_positions;             ///< [node_count], world
  std::vector<std::array<std::int32_t, 4>> tets;  ///< [tet_count], indices into rest_positions, in
                                                  ///< either orientation
  /// [hex_count], indices in VTK's order: 0 to 3 around the bottom, 4 to 7 above them. Within a
  /// hexahedron positions are interpolated trilinearly. Each of its faces is divided into two
  /// triangles by the diagonal from the face's lowest node number; tetrahedra on the other side of
  /// the face must have these two triangles.
  std::vector<std::array<std::int32_t, 8>> hexes = {};

  /// Tetrahedra and hexahedra.
  std::size_t cell_count() const { return tets.size() + hexes.size(); }
};

/// Checks that there is a cell, that indices are in range and that positions are finite.
/// @throws std::invalid_argument naming the first violation
TETWARP_EXPORT void check_mesh(const Mesh& mesh);

/// Node positions that the caller owns, in host memory or on a GPU: x y z per node, float64, world.
struct PositionsView {
  const double* xyz = nullptr;  ///< [node_count][3]
  std::int64_t node_count = 0;
  Memory memory = Memory::host;

  PositionsView() = default;
  PositionsView(const std::vector<Point3>& positions)
      : xyz(positions.empty() ? nullptr : positions.front().data()),
        node_count(static_cast<std::int64_t>(positions.size())) {}
  PositionsView(const double* positions, std::int64_t nodes, Memory where)
      : xyz(positions), node_count(nodes), memory(where) {}
};

}  // namespace tetwarp

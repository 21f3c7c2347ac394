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

/// Nodes at rest and the nodes of each cell. Cells are numbered tetrahedra first, then hexahedra.
struct Mesh {
  std::vector<Point3> rest_positions;             ///< [node_count], world
  std::vector<std::array<std::int32_t, 4>> tets;  ///< [tet_count], either orientation; indices
                                                  ///< into rest_positions
  /// [hex_count], in VTK's order: 0 to 3 around the bottom, 4 to 7 above them. Inside, positions go
  /// by the trilinear map. A face between hexahedra is cut from its node of the lowest number; a
  /// tetrahedron that joins it must be cut alike.
  std::vector<std::array<std::int32_t, 8>> hexes = {};

  std::size_t cell_count() const { return tets.size() + hexes.size(); }
};

/// Throws std::invalid_argument naming the first offender unless there is a cell, every
/// index is in range and every position finite.
TETWARP_EXPORT void check_mesh(const Mesh& mesh);

/// Node positions owned by somebody else, possibly on the GPU: x y z per node, float64, world.
struct PositionsView {
  const double* xyz = nullptr;
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

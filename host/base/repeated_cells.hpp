/// @file repeated_cells.hpp
/// Cells that are there twice: members of two groups, ghost copies of other partitions.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tetwarp/curved_mesh.hpp>
#include <tetwarp/export.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// What makes two cells the same. Cells with two nodes at one place are compared by node numbers.
enum class SameCells {
  places,         ///< the places of their nodes, in any order
  turned_places,  ///< the places of their nodes, in the same orientation: two triangles back to
                  ///< back are different
  nodes           ///< their nodes, in any order
};

/// Per cell the first one that is the same.
/// @pre nodes are indices of points
template <std::size_t nodes_per_cell>
TETWARP_EXPORT std::vector<std::size_t> first_copies(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, nodes_per_cell>>& cells,
    SameCells same);

/// Per tetrahedron the first one of the same corners whose edges are bent alike.
/// @param mid_nodes  as those of CurvedMesh
TETWARP_EXPORT std::vector<std::size_t> first_tet_copies(
    const std::vector<Point3>& points,
    const std::vector<std::array<std::int32_t, 4>>& tets,
    const std::vector<MidNodes>& mid_nodes);

/// How many cells are not the first of their kind.
TETWARP_EXPORT std::size_t copy_count(const std::vector<std::size_t>& firsts);

/// "4 of 12 triangles are there twice and were merged"; empty for none.
/// @param name  of several cells
TETWARP_EXPORT std::string merged_text(std::size_t copies, std::size_t cells, const char* name);

/// Keeps the first rows of cells or of what belongs to them.
template <class Row>
void keep_firsts(const std::vector<std::size_t>& firsts, std::vector<Row>& rows) {
  std::size_t kept = 0;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (firsts[row] == row) rows[kept++] = rows[row];
  }
  rows.resize(kept);
}

}  // namespace tetwarp

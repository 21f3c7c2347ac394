/// @file lattice_cells.hpp
/// Lattices of boxes, and the mesh of their cells.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/mesh.hpp>

#include "host/base/point3.hpp"

namespace tetwarp {

/// Boxes along the axes of some frame: node (a, b, c) is at start + edge * (a, b, c).
struct LatticeFrame {
  std::array<std::int64_t, 3> cells{1, 1, 1};
  Point3 start{0, 0, 0};
  Point3 edge{1, 1, 1};

  /// Numbers with a fastest.
  std::size_t cell_id(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return static_cast<std::size_t>((c * cells[1] + b) * cells[0] + a);
  }
  std::size_t node_id(std::int64_t a, std::int64_t b, std::int64_t c) const {
    return static_cast<std::size_t>((c * (cells[1] + 1) + b) * (cells[0] + 1) + a);
  }
  std::size_t cell_count() const { return cell_id(0, 0, cells[2]); }
};

/// Boxes of the given edges that cover `bounds`, with the middle of the lattice at the middle of
/// the bounds, moved by `offset` edges and then with one box more along each axis if needed.
LatticeFrame covering_frame(const Bounds& bounds, const Point3& edge, double offset);

/// Into what each cell of a lattice is divided.
enum class LatticeDivision { five_tets, one_hex };

/// The tetrahedra or hexahedra of cells, cell by cell, and the nodes that they use, in the order of
/// their numbers. Volumes are positive in the frame.
/// @param is_kept  [cells] other than 0: the cell is part of the mesh; or empty: all are
Mesh mesh_of_cells(const LatticeFrame& frame,
                   const std::vector<std::uint8_t>& is_kept,
                   LatticeDivision division);

}  // namespace tetwarp

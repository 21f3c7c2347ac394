/// @file lattice_cells.cpp
/// Frames, nodes and cells of lattices.
#include "host/base/lattice_cells.hpp"

#include <algorithm>
#include <cmath>

#include "host/base/five_tets.hpp"

namespace tetwarp {

LatticeFrame covering_frame(const Bounds& bounds, const Point3& edge, double offset) {
  LatticeFrame frame{{1, 1, 1}, {}, edge};
  for (std::size_t d = 0; d < 3; ++d) {
    const double extent = bounds.high[d] - bounds.low[d];
    // Lengths within rounding of a whole number of edges need no further box.
    const double count = std::max(1.0, std::ceil(extent / edge[d] - 1e-9) + (offset > 0 ? 1 : 0));
    frame.cells[d] = static_cast<std::int64_t>(count);
    const double middle = bounds.low[d] + 0.5 * extent;
    frame.start[d] = middle - (0.5 * count - (offset > 0 ? 0.5 - offset : 0)) * edge[d];
  }
  return frame;
}

Mesh mesh_of_cells(const LatticeFrame& frame,
                   const std::vector<std::uint8_t>& is_kept,
                   LatticeDivision division) {
  const auto& cells = frame.cells;
  const auto for_kept = [&](const auto& visit) {
    for (std::int64_t c = 0; c < cells[2]; ++c) {
      for (std::int64_t b = 0; b < cells[1]; ++b) {
        for (std::int64_t a = 0; a < cells[0]; ++a) {
          if (is_kept.empty() || is_kept[frame.cell_id(a, b, c)]) visit(a, b, c);
        }
      }
    }
  };
  std::vector<std::int32_t> number(frame.node_id(0, 0, cells[2] + 1), -1);
  const auto corner_of = [&](std::int64_t a, std::int64_t b, std::int64_t c,
                             int corner) -> std::int32_t& {
    return number[frame.node_id(a + (corner & 1), b + (corner >> 1 & 1), c + (corner >> 2))];
  };
  std::size_t kept_count = 0;
  for_kept([&](std::int64_t a, std::int64_t b, std::int64_t c) {
    ++kept_count;
    for (int corner = 0; corner < 8; ++corner) corner_of(a, b, c, corner) = 0;
  });
  Mesh mesh;
  std::size_t node = 0;
  for (std::int64_t c = 0; c <= cells[2]; ++c) {
    for (std::int64_t b = 0; b <= cells[1]; ++b) {
      for (std::int64_t a = 0; a <= cells[0]; ++a, ++node) {
        if (number[node] < 0) continue;
        number[node] = static_cast<std::int32_t>(mesh.rest_positions.size());
        mesh.rest_positions.push_back({frame.start[0] + frame.edge[0] * static_cast<double>(a),
                                       frame.start[1] + frame.edge[1] * static_cast<double>(b),
                                       frame.start[2] + frame.edge[2] * static_cast<double>(c)});
      }
    }
  }
  const bool hexahedra = division == LatticeDivision::one_hex;
  if (hexahedra) {
    mesh.hexes.reserve(kept_count);
  } else {
    mesh.tets.reserve(5 * kept_count);
  }
  for_kept([&](std::int64_t a, std::int64_t b, std::int64_t c) {
    const auto add = [&](auto& list, const auto& corners) {
      auto& nodes = list.emplace_back();
      for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = corner_of(a, b, c, corners[n]);
    };
    if (hexahedra) {
      add(mesh.hexes, std::array{0, 1, 3, 2, 4, 5, 7, 6});
    } else {
      for (const auto& corners : tets_of_cell[(a + b + c) % 2]) add(mesh.tets, corners);
    }
  });
  return mesh;
}

}  // namespace tetwarp

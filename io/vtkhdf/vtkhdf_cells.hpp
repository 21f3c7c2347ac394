/// @file vtkhdf_cells.hpp
/// Cells of a VTKHDF UnstructuredGrid of one part that is written.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tetwarp/volume.hpp>

#include "io/h5/h5.hpp"

namespace tetwarp {

/// Cells in the form of the file.
struct CellRows {
  std::vector<std::uint8_t> types;       ///< of VTK
  std::vector<std::int64_t> offsets{0};  ///< first node of each cell in `nodes`, then their number
  std::vector<std::int32_t> nodes;

  /// Adds cells of one type.
  template <std::size_t nodes_per_cell>
  void add(std::uint8_t type, std::span<const std::array<std::int32_t, nodes_per_cell>> cells) {
    for (const auto& cell : cells) {
      types.push_back(type);
      nodes.insert(nodes.end(), cell.begin(), cell.end());
      offsets.push_back(static_cast<std::int64_t>(nodes.size()));
    }
  }
};

/// Writes the points and cells below /VTKHDF.
void write_grid(const h5::Object& root, std::span<const Point3> points, const CellRows& cells);

/// Writes a dataset of integers of shape [n] or, as a column, [n][1].
void write_integers(const h5::Object& parent,
                    const std::string& name,
                    const std::vector<std::int64_t>& values,
                    bool is_column = false);

}  // namespace tetwarp

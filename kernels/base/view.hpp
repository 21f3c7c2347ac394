/// @file view.hpp
/// Members of stage bodies: arrays without ownership, and the integer geometry of the output grid.
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// A pointer and a number of elements; owns nothing.
template <class T>
struct View {
  T* data = nullptr;
  std::int64_t size = 0;

  TETWARP_HD T& operator[](std::int64_t i) const { return data[i]; }
  template <class Const>
  requires std::is_same_v<Const, const T> TETWARP_HD operator View<Const>() const {
    return {data, size};
  }
  bool operator==(const View&) const = default;  ///< the same memory
};

constexpr int cell_edge = 8;  ///< voxels along the edge of a cell
constexpr int cell_shift = 3;

/// The output in frame coordinates. The frame is the output grid's index space shifted by whole
/// cells: a region of the grid has the same cells, and the same result bits, as in the full grid.
struct OutputFrame {
  std::int64_t origin[3];  ///< grid index of frame voxel (0, 0, 0): a multiple of 8
  int begin[3];            ///< first voxel to compute, in 0..7 [frame]
  int end[3];              ///< one past the last [frame]
  int cells[3];            ///< cells along each axis

  TETWARP_HD std::int64_t cell_count() const {
    return std::int64_t{cells[0]} * cells[1] * cells[2];
  }
  TETWARP_HD std::int64_t voxel_count() const {
    return std::int64_t{end[0] - begin[0]} * (end[1] - begin[1]) * (end[2] - begin[2]);
  }
  /// Position of a frame voxel in the output array.
  TETWARP_HD std::int64_t offset_of(int i, int j, int k) const {
    const std::int64_t slice = std::int64_t{k - begin[2]} * (end[1] - begin[1]) + (j - begin[1]);
    return slice * (end[0] - begin[0]) + (i - begin[0]);
  }
  /// First voxel [frame] of a row of the output array; rows along i are numbered j fastest.
  TETWARP_HD void set_row_start(std::int64_t row, int* ijk) const {
    const int ny = end[1] - begin[1];
    ijk[0] = begin[0];
    ijk[1] = begin[1] + static_cast<int>(row % ny);
    ijk[2] = begin[2] + static_cast<int>(row / ny);
  }
  /// The frame voxel at a position of the output array: the inverse of offset_of().
  TETWARP_HD void set_voxel(std::int64_t offset, int* ijk) const {
    const int nx = end[0] - begin[0];
    set_row_start(offset / nx, ijk);
    ijk[0] += static_cast<int>(offset % nx);
  }
  TETWARP_HD std::int64_t cell_index(int ci, int cj, int ck) const {
    return (std::int64_t{ck} * cells[1] + cj) * cells[0] + ci;
  }
  /// The cell that a frame voxel belongs to.
  TETWARP_HD std::int64_t cell_of_voxel(const int* ijk) const {
    return cell_index(ijk[0] >> cell_shift, ijk[1] >> cell_shift, ijk[2] >> cell_shift);
  }
  /// First voxel [frame] of a cell.
  /// @tparam Index  std::int64_t, or std::uint32_t, whose divisions are shorter on a device
  template <class Index>
  TETWARP_HD void set_corner(Index cell, int* corner) const {
    const auto nx = static_cast<Index>(cells[0]), ny = static_cast<Index>(cells[1]);
    const Index line = cell / nx, layer = line / ny;
    corner[0] = static_cast<int>(cell - line * nx) * cell_edge;
    corner[1] = static_cast<int>(line - layer * ny) * cell_edge;
    corner[2] = static_cast<int>(layer) * cell_edge;
  }
};

}  // namespace tetwarp

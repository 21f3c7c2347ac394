/// @file brick_grid.hpp
/// The order in which the cpu back end visits cells: bricks of 4x4x4, whose part of the source
/// stays in the second-level cache however the map turns it.
#pragma once
#include <algorithm>
#include <cstdint>

#include "kernels/view.hpp"

namespace tetwarp {

class BrickGrid {
 public:
  static constexpr int edge = 4;  ///< cells

  explicit BrickGrid(const OutputFrame& frame) {
    for (int axis = 0; axis < 3; ++axis) {
      cells_[axis] = frame.cells[axis];
      bricks_[axis] = (frame.cells[axis] + edge - 1) / edge;
    }
  }

  std::int64_t count() const { return std::int64_t{bricks_[0]} * bricks_[1] * bricks_[2]; }

  /// work(ci, cj, ck) for every cell of a brick, i fastest.
  template <class Work>
  void for_each_cell(std::int64_t brick, Work&& work) const {
    const std::int64_t line = brick / bricks_[0];
    const int begin[3] = {static_cast<int>(brick % bricks_[0]) * edge,
                          static_cast<int>(line % bricks_[1]) * edge,
                          static_cast<int>(line / bricks_[1]) * edge};
    int end[3];
    for (int axis = 0; axis < 3; ++axis) end[axis] = std::min(begin[axis] + edge, cells_[axis]);
    for (int ck = begin[2]; ck < end[2]; ++ck) {
      for (int cj = begin[1]; cj < end[1]; ++cj) {
        for (int ci = begin[0]; ci < end[0]; ++ci) work(ci, cj, ck);
      }
    }
  }

 private:
  int cells_[3];
  int bricks_[3];
};

}  // namespace tetwarp

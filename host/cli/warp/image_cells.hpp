/// @file image_cells.hpp
/// Cells of a displacement field or a spline, and where they are taken.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tetwarp/resample.hpp>

#include "host/base/point3.hpp"

namespace tetwarp::cli {

/// The cells between the nodes of a field or a spline, each with a box around all positions to
/// which it is taken. Bricks of 8 x 8 x 8 cells have boxes, too, so that cells near a position are
/// found.
class ImageCells {
 public:
  /// @param field  a DisplacementField or a BSplineTransform, kept by the caller
  ImageCells(const Transform& field, int threads);

  /// Calls visit(low, high, image) for each cell of the bricks that may be taken to positions in
  /// `near`. The cell reaches from index low to index high.
  template <class Visit>
  void for_each_near(const Bounds& near, const Visit& visit) const {
    for (std::size_t b = 0; b < bricks_.size(); ++b) {
      if (!meet(bricks_[b], near)) continue;
      for_each_cell(static_cast<std::int64_t>(b), visit);
    }
  }

  /// Whether two boxes share a position.
  static bool meet(const Bounds& a, const Bounds& b);

 private:
  using Cell = std::array<std::int64_t, 3>;

  /// Of a brick.
  template <class Visit>
  void for_each_cell(std::int64_t brick, const Visit& visit) const {
    const Cell at{brick % brick_count_[0], brick / brick_count_[0] % brick_count_[1],
                  brick / brick_count_[0] / brick_count_[1]};
    Cell begin{}, end{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      begin[axis] = first_ + side * at[axis];
      end[axis] = std::min(begin[axis] + side, grid_->dims[axis] + end_);
    }
    for (std::int64_t k = begin[2]; k < end[2]; ++k) {
      for (std::int64_t j = begin[1]; j < end[1]; ++j) {
        for (std::int64_t i = begin[0]; i < end[0]; ++i) {
          const Cell cell{i, j, k};
          visit(index_of(cell), index_of({i + 1, j + 1, k + 1}), image_of(cell));
        }
      }
    }
  }

  Point3 index_of(const Cell& node) const;
  Bounds image_of(const Cell& cell) const;
  void widen(const Cell& cell, Bounds& image) const;

  static constexpr std::int64_t side = 8;  ///< of a brick [cell]

  const Grid* grid_ = nullptr;
  const float* linear_ = nullptr;
  const double* spline_ = nullptr;
  // A linear field goes on for half a voxel beyond its outermost centers, a spline ends one knot
  // before its outermost ones.
  std::int64_t first_ = -1;
  std::int64_t end_ = 0;  ///< added to the nodes along an axis
  Cell brick_count_{};
  std::vector<Bounds> bricks_;
};

}  // namespace tetwarp::cli

/// @file overlap_weights.hpp
/// The matrix of a warp that keeps totals.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/cpu/cell_overlap.hpp"

namespace tetwarp {

/// What an output voxel takes of a voxel of the source.
struct OverlapShare {
  std::int64_t voxel;  ///< of the source
  double weight;       ///< above 0: volume that is moved over that of the output voxel, times what
                       ///< the tetrahedra grow
};

/// The shares of all output voxels. They are stored: to integrate a voxel takes longer than to read
/// its shares a hundred times.
class OverlapWeights {
 public:
  /// @param plan  of operator_plan(), with Intensity::conservative
  /// @param mask  as WarpOperatorOptions::mask
  /// @throws std::invalid_argument  on wrong positions
  OverlapWeights(const WarpPlan& plan,
                 const std::vector<Point3>& deformed,
                 const std::vector<std::uint8_t>& mask,
                 int threads);

  /// Calls visit(voxel, shares) for the voxels of a row along i that have shares.
  template <class Visit>
  void for_row(std::int64_t row, const Visit& visit) const {
    int x[3];
    frame_.set_row_start(row, x);
    for (; x[0] < frame_.end[0]; ++x[0]) {
      const Cell& cell = cells_[static_cast<std::size_t>(frame_.cell_of_voxel(x))];
      if (cell.shares.empty()) continue;
      const auto at = static_cast<std::size_t>(voxel_in_cell(x));
      const std::span<const OverlapShare> shares(cell.shares.begin() + cell.begin[at],
                                                 cell.shares.begin() + cell.begin[at + 1]);
      if (!shares.empty()) visit(frame_.offset_of(x[0], x[1], x[2]), shares);
    }
  }

 private:
  struct Cell {
    std::vector<OverlapShare> shares;
    std::vector<std::int64_t> begin;  ///< per voxel of the cell, and the end; empty: no shares
  };

  static int voxel_in_cell(const int* x) {
    constexpr int last = cell_edge - 1;
    return ((x[2] & last) * cell_edge + (x[1] & last)) * cell_edge + (x[0] & last);
  }
  void set_cell(std::int64_t cell,
                CellOverlapMemory& memory,
                const std::vector<std::uint8_t>& mask,
                double voxel_ratio);
  void add_shares(std::vector<FacetPart>& parts,
                  double least,
                  double voxel_ratio,
                  Cell& cell) const;
  void add_bar(std::span<const FacetPart> parts,
               double least,
               double voxel_ratio,
               Cell& cell) const;

  OutputFrame frame_;
  std::array<std::int64_t, 3> dims_;  ///< of the source
  std::vector<Cell> cells_;
};

}  // namespace tetwarp

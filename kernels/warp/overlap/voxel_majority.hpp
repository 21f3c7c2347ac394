/// @file voxel_majority.hpp
/// Stage "raster" of labels by volume: a voxel gets the label that fills most of its box.
#pragma once
#include <cstdint>

#include "kernels/warp/overlap/box_overlaps.hpp"
#include "kernels/warp/sample/label_shares.hpp"

namespace tetwarp {

/// Shares of the labels in a voxel's box.
class LabelSums {
 public:
  static constexpr bool skips_zeros = false;

  /// @param rest_orientation  sign of the rest volume of each tetrahedron
  TETWARP_HD LabelSums(LabelShares& shares, View<const std::int8_t> rest_orientation)
      : shares_(shares), rest_orientation_(rest_orientation) {}

  /// The parts of a box have the volume that they have in the output; what is flat at rest has
  /// none.
  TETWARP_HD double scale_of(int t) const { return rest_orientation_[t] == 0 ? 0 : 1; }

  template <class T>
  TETWARP_HD void add(const T* sample, int /*components*/, double share) {
    covered_ += share;
    shares_.add(static_cast<double>(*sample), share);
  }
  TETWARP_HD double covered() const { return covered_; }

 private:
  LabelShares& shares_;
  View<const std::int8_t> rest_orientation_;
  double covered_ = 0;
};

/// One index = one voxel of the output, counted from `first`; any order.
struct VoxelMajorityOp : BoxOverlaps {
  static constexpr int resident_blocks = 2;  ///< leaves 128 registers per thread: no spills
  View<const std::int8_t> rest_orientation;  ///< sign of the rest volume, shape [tet_count]
  NumberView output;                         ///< labels [k][j][i]
  double background;
  std::int64_t first = 0;  ///< voxel of index 0

  TETWARP_HD void operator()(std::int64_t index) const {
    const std::int64_t voxel = first + index;
    int x[3];
    frame.set_voxel(voxel, x);
    const std::int64_t cell = frame.cell_of_voxel(x);
    if (is_kept(cell)) return;
    constexpr double tie = 0x1p-16;  // above the error of shares by the rounding of nodes
    output.set(voxel, label_of_largest_share(background, tie, [&](LabelShares& shares) {
                 shares.add(background, 0);
                 LabelSums sums(shares, rest_orientation);
                 add_voxel(x, cell, sums);
                 shares.add_to(background, max_of(1 - sums.covered(), 0.0));
               }));
  }
};

/// Sets voxels to the label with the largest volume in their box, where the source's voxels are
/// boxes that move with the tetrahedra. What no tetrahedron covers and what comes from beyond the
/// source counts for the background. Shares of the box that differ by at most 2^-16 are equal,
/// which is more than they change by the rounding of nodes to 2^-20 voxel: of equal ones the lowest
/// label wins.
///
/// Shares are exact but for rounding of float64 sums. Where tetrahedra overlap, their shares add
/// up; those that are flat in one of the states have none.
/// @param exec   where to run
/// @param op     input and output, see VoxelMajorityOp; one component of at most 32 bits
/// @param count  voxels to set, from op.first on
///
/// Determinism: the same labels on every back end, but where shares differ by 2^-16 to within
/// 2^-44. Cost: as voxel_overlap(), once per 12 labels in the box; little within one label and one
/// tetrahedron. Source: ours.
template <class Exec>
void voxel_majority(Exec& exec, const VoxelMajorityOp& op, std::int64_t count) {
  exec.for_each("warp/raster", count, op);
}

}  // namespace tetwarp

/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel is the integral over its box. The source is
/// taken as constant in the box of each of its voxels and moved with the tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/warp/overlap/box_overlaps.hpp"
#include "kernels/warp/overlap/voxel_rounding.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

/// Amounts per component: of each part its share times its sample.
class AmountSums {
 public:
  static constexpr bool skips_zeros = true;

  /// @param transforms  only their scale is used, 0 of what is flat at rest
  TETWARP_HD explicit AmountSums(View<const VoxelTransform> transforms) : transforms_(transforms) {}

  TETWARP_HD double scale_of(int t) const { return transforms_[t].scale; }
  template <class T>
  TETWARP_HD void add(const T* sample, int components, double share) {
    for (int c = 0; c < components; ++c) sums_[c] += share * static_cast<double>(sample[c]);
  }
  TETWARP_HD const double* sums() const { return sums_; }

 private:
  View<const VoxelTransform> transforms_;
  double sums_[max_transform_components] = {};
};

/// One index = one voxel of the output, counted from `first`; any order.
struct VoxelOverlapOp : BoxOverlaps {
  static constexpr int resident_blocks = 2;  ///< leaves 128 registers per thread: no spills
  View<const VoxelTransform> transforms;     ///< only their scale is used
  VoxelRounding output;
  std::int64_t first = 0;  ///< voxel of index 0

  TETWARP_HD void operator()(std::int64_t index) const {
    const std::int64_t voxel = first + index;
    int x[3];
    frame.set_voxel(voxel, x);
    const std::int64_t cell = frame.cell_of_voxel(x);
    if (is_kept(cell)) return;
    AmountSums sums(transforms);
    add_voxel(x, cell, sums);
    output.store(voxel, x, sums.sums());
  }
};

/// Sets voxels to the integral of the deformed source over its box, divided by the volume of a
/// voxel. The total over the output is the total of the source over the mesh at rest.
///
/// Exact but for rounding of float64 sums, added in the order of tetrahedra and of source voxels,
/// and for storing them: see VoxelRounding.
/// Where tetrahedra overlap, their contributions add up; flat ones contribute nothing.
/// @param exec  where to run
/// @param body  input and output, see VoxelOverlapOp
/// @param count  voxels to set, from body.first on
/// @pre body.components is at most max_transform_components; the public calls check it
///
/// Determinism: values agree within 2^-44 relative between back ends. Cost: about a microsecond
/// per voxel within a tetrahedron, most of it for following the edges of its faces through the
/// source; little where the source is constant.
/// Source: ours; integration over intersections in a remap that keeps totals: J. K. Dukowicz, 1984.
template <class Exec>
void voxel_overlap(Exec& exec, const VoxelOverlapOp& body, std::int64_t count) {
  exec.for_each("warp/raster", count, body);
}

}  // namespace tetwarp

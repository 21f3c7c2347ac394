/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel is the integral over its box. The source is
/// taken as constant in the box of each of its voxels and moved with the tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/warp/box_overlaps.hpp"
#include "kernels/warp/voxel_rounding.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

/// One index = one tetrahedron; any order. Extends its box to all voxels that it intersects, and
/// replaces a whole-voxel shift that is not exact by the exact map.
struct TetWidenOp {
  View<const std::int32_t> tets;
  View<const Node> nodes;
  View<const Node> rest;
  View<const std::uint8_t> moved;  ///< others do not change; size 0: all have moved
  OutputFrame frame;
  View<TetSetup> setups;
  View<std::int64_t> pair_counts;

  TETWARP_HD void operator()(std::int64_t t) const {
    TetSetup& setup = setups[t];
    const bool has_shape =
        setup.tet_class == TetClass::regular || setup.tet_class == TetClass::inverted;
    if (!has_shape || (moved.size > 0 && moved[t] == 0)) return;
    const TetNodes output = tet_nodes(nodes, tets.data + 4 * t);
    widen_box(output, frame, setup);
    // A shift that is exact only to within a quantum would not keep the total exactly.
    const TetNodes source = tet_nodes(rest, tets.data + 4 * t);
    if (setup.kind == MapKind::copy && !is_exact_shift(output, source)) {
      Barycentric of_nodes[4];
      set_planes<Int128>(output, setup, of_nodes);
      set_map(source, of_nodes, setup);
    }
    pair_counts[t] = box_cells(setup);
  }

  TETWARP_HD static bool is_exact_shift(const TetNodes& output, const TetNodes& source) {
    bool exact = true;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t shift = source.x[0][axis] - output.x[0][axis];
      exact = exact && shift % quanta_per_voxel == 0;
      for (int a = 1; a < 4; ++a) {
        exact = exact && source.x[a][axis] - output.x[a][axis] == shift;
      }
    }
    return exact;
  }
};

/// Stage "setup", after tet_setup(): extends the setup of tetrahedra for voxel_overlap().
/// @param exec   where to run
/// @param setup  as given to tet_setup()
/// @param moved  tetrahedra to extend, from tet_moved; empty: all
///
/// Determinism: as tet_setup(). Cost: 96 bytes read and 40 written per tetrahedron. Source: ours.
template <class Exec>
void tet_widen(Exec& exec, const TetSetupOp& setup, View<const std::uint8_t> moved) {
  exec.for_each("warp/setup", setup.setups.size,
                TetWidenOp{setup.tets, setup.deformed, setup.rest, moved, setup.frame, setup.setups,
                           setup.pair_counts});
}

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

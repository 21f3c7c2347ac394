/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel is the integral over its box. The source is
/// taken as constant in the box of each of its voxels and moved with the tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/convex_part.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

/// One index = one tetrahedron; any order. Extends its box to all voxels that it intersects, and
/// replaces a whole-voxel shift that is not exact by the exact map.
struct TetWidenBody {
  View<const std::int32_t> tets;
  View<const Node> nodes;
  View<const Node> rest;
  View<const std::uint8_t> moved;  ///< others do not change; size 0: all have moved
  OutputFrame frame;
  View<TetSetup> setups;
  View<std::int64_t> corner_counts;
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
      double gradient[4][3], at_anchor[4];
      set_planes<Int128>(output, setup, gradient, at_anchor);
      set_map(source, gradient, at_anchor, setup);
    }
    corner_counts[t] = 0;
    pair_counts[t] = is_empty(setup) ? 0 : 1;
    for (int axis = 0; axis < 3; ++axis) {
      pair_counts[t] *= last_cell(setup, axis) - first_cell(setup, axis) + 1;
    }
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
void tet_widen(Exec& exec, const TetSetupBody& setup, View<const std::uint8_t> moved) {
  exec.for_each("warp/setup", setup.setups.size,
                TetWidenBody{setup.tets, setup.deformed, setup.rest, moved, setup.frame,
                             setup.setups, setup.corner_counts, setup.pair_counts});
}

/// One index = one voxel of the output, counted from `first`; any order.
struct VoxelOverlapBody {
  static constexpr int resident_blocks = 1;  ///< allows all registers: no spills
  View<const TetSetup> setups;
  View<const VoxelTransform> transforms;  ///< only their scale is used
  PairList list;                          ///< of widened boxes, none rejected
  View<const std::int64_t> cell_work;     ///< only keep_cell is used; size 0: no cell is kept
  OutputFrame frame;
  NumberView source;
  int dims[3];
  int components;
  NumberView volume;
  std::int64_t first = 0;  ///< voxel of index 0

  /// Scratch: the part of the voxel's box in the tetrahedron, a spare one, and one part per axis of
  /// the source.
  struct Parts {
    ConvexPart two[2], cut[3];
    ConvexPart* spare;
  };

  TETWARP_HD void operator()(std::int64_t index) const {
    const std::int64_t voxel = first + index;
    int x[3];
    frame.set_voxel(voxel, x);
    const std::int64_t cell = frame.cell_of_voxel(x);
    if (cell_work.size > 0 && cell_work[cell] == keep_cell) return;
    double sums[max_transform_components] = {};
    const std::int64_t end = end_of_cell(list, cell);
    for (std::int64_t p = list.ranges[cell].begin; p < end; ++p) {
      add_tet(tet_of(list.pairs[p]), x, sums);
    }
    for (int c = 0; c < components; ++c) volume.set(voxel * components + c, sums[c]);
  }

  /// Adds the contribution of tetrahedron t to voxel x.
  TETWARP_HD void add_tet(int t, const int* x, double* sums) const {
    const TetSetup& tet = setups[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (x[axis] < tet.begin[axis] || x[axis] >= tet.end[axis]) return;
    }
    Parts parts;
    const ConvexPart* const whole = part_in_tet(tet, x[0], x[1], x[2], parts.two[0], parts.two[1]);
    if (whole == nullptr) return;
    parts.spare = parts.two + (whole == parts.two ? 1 : 0);
    double start[3], linear[3][3];
    map_start(tet, x, start, linear);
    const auto map = make_source_map<double>(start, linear);
    for_slabs(parts, map, 2, *whole, [&](std::int64_t k, const ConvexPart& slab) {
      for_slabs(parts, map, 1, slab, [&](std::int64_t j, const ConvexPart& bar) {
        for_slabs(parts, map, 0, bar, [&](std::int64_t i, const ConvexPart& piece) {
          const double share = volume_of(piece) * transforms[t].scale;
          if (!(share > 0)) return;
          const std::int64_t from = ((k * dims[1] + j) * dims[0] + i) * components;
          for (int c = 0; c < components; ++c) sums[c] += share * source.at(from + c);
        });
      });
    });
  }

  /// Cuts a body into slabs, one per voxel n of the source along axis `row`, and calls visit(n,
  /// slab) for each.
  template <class Visit>
  TETWARP_HD void for_slabs(Parts& parts,
                            const SourceMap<double>& map,
                            int row,
                            const ConvexPart& body,
                            Visit&& visit) const {
    const Extent extent = extent_of(body, map, row);
    const double first = max_of(floor(extent.low + 0.5), -static_cast<double>(map.whole[row]));
    const double last =
        min_of(ceil(extent.high - 0.5), static_cast<double>(dims[row] - 1) - map.whole[row]);
    for (double n = first; n <= last; ++n) {
      const ConvexPart* const part = slab_of(body, map, row, extent, n, parts);
      if (part != nullptr) visit(map.whole[row] + static_cast<std::int64_t>(n), *part);
    }
  }

  /// Extent of a body along an axis of the source, relative to map.whole [source voxel].
  struct Extent {
    double low, high;
  };
  TETWARP_HD_RARE static Extent extent_of(const ConvexPart& body,
                                          const SourceMap<double>& map,
                                          int row) {
    const double normal[3] = {map.axis[0][row], map.axis[1][row], map.axis[2][row]};
    Extent extent = {height_over(normal, map.base[row], body.corner[0]), 0};
    extent.high = extent.low;
    for (int c = 1; c < body.corner_count; ++c) {
      const double height = height_over(normal, map.base[row], body.corner[c]);
      extent.low = min_of(extent.low, height);
      extent.high = max_of(extent.high, height);
    }
    return extent;
  }

  /// The part of a body in slab n of the source: the body itself, a part in scratch, or null.
  TETWARP_HD_RARE static const ConvexPart* slab_of(const ConvexPart& body,
                                                   const SourceMap<double>& map,
                                                   int row,
                                                   const Extent& extent,
                                                   double n,
                                                   Parts& parts) {
    const double normal[3] = {map.axis[0][row], map.axis[1][row], map.axis[2][row]};
    const double opposite[3] = {-normal[0], -normal[1], -normal[2]};
    const bool ends = extent.high > n + 0.5;
    const ConvexPart* part = &body;
    if (extent.low < n - 0.5) {
      ConvexPart& to = ends ? *parts.spare : parts.cut[row];
      if (!clip_part(*part, normal, map.base[row] - (n - 0.5), to)) return nullptr;
      part = &to;
    }
    if (!ends) return part;
    const double offset = n + 0.5 - map.base[row];
    return clip_part(*part, opposite, offset, parts.cut[row]) ? &parts.cut[row] : nullptr;
  }
};

/// Sets voxels to the integral of the deformed source over its box, divided by the volume of a
/// voxel. The total over the output is the total of the source over the mesh at rest.
///
/// Exact but for rounding of float64 sums, added in the order of tetrahedra and of source voxels.
/// Where tetrahedra overlap, their contributions add up; flat ones contribute nothing.
/// @param exec  where to run
/// @param body  input and output, see VoxelOverlapBody
/// @param count  voxels to set, from body.first on
/// @pre body.components is at most max_transform_components; the public calls check it
///
/// Determinism: values agree within 2^-44 relative between back ends. Cost: microseconds per voxel,
/// one cut by a plane for each pair of a source and an output voxel that intersect.
/// Source: ours; integration over intersections in a remap that keeps totals: J. K. Dukowicz, 1984.
template <class Exec>
void voxel_overlap(Exec& exec, const VoxelOverlapBody& body, std::int64_t count) {
  exec.for_each("warp/raster", count, body);
}

}  // namespace tetwarp

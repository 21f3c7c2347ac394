/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel gets what lies in its box. The source is
/// constant in the box of each of its voxels; every tetrahedron carries what it holds of them.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/convex_part.hpp"
#include "kernels/warp/voxel_transform.hpp"

namespace tetwarp {

/// Sets boxes to all voxels that tetrahedra touch, and maps to what the nodes say. One index = one
/// tetrahedron; any order.
struct TetWidenBody {
  View<const std::int32_t> tets;
  View<const Node> nodes;
  View<const Node> rest;
  View<const std::uint8_t> moved;  ///< others are left as they are; size 0: all have
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
    // A shift that holds to within a quantum only would carry a little more or less.
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

/// Stage "setup", behind tet_setup: tetrahedra as VoxelOverlapBody needs them.
/// @param exec   where to run
/// @param setup  as tet_setup() had it
/// @param moved  the tetrahedra that it was made for; empty: all
template <class Exec>
void tet_widen(Exec& exec, const TetSetupBody& setup, View<const std::uint8_t> moved) {
  exec.for_each("warp/setup", setup.setups.size,
                TetWidenBody{setup.tets, setup.deformed, setup.rest, moved, setup.frame,
                             setup.setups, setup.corner_counts, setup.pair_counts});
}

/// One index = one voxel of the output; any order.
struct VoxelOverlapBody {
  static constexpr int resident_blocks = 1;  ///< all registers: no spills
  View<const TetSetup> setups;
  View<const VoxelTransform> transforms;  ///< their scale
  PairList list;                          ///< of widened boxes, none rejected
  View<const std::int64_t> cell_work;     ///< cells to keep; size 0: none
  OutputFrame frame;
  NumberView source;
  int dims[3];
  int components;
  NumberView volume;

  /// Room for a body and scratch, and for what is cut along the axes of the source in turn.
  struct Parts {
    ConvexPart two[2], cut[3];
    ConvexPart* spare;
  };

  TETWARP_HD void operator()(std::int64_t voxel) const {
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

  /// Adds what tetrahedron t brings to the voxel x.
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

  /// visit(n, part) for the parts of a body that lie in voxels n of the source along a row.
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

  /// Of a body along an axis of the source, from map.whole on.
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

  /// What of a body lies in slab n of the source: the body itself, or a cut one, or null.
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

/// Gives every voxel the integral of the source over what the tetrahedra bring of it, over the
/// volume of a voxel: the total over the output is that over the mesh at rest.
///
/// Exact but for rounding: of float64 sums, in the order of tetrahedra and of source voxels. Where
/// tetrahedra overlap each brings its own; one that is flat brings nothing.
/// @param exec  where to run
/// @param body  see VoxelOverlapBody
///
/// Determinism: values within 2^-44 of what a voxel gets between back ends. Cost: microseconds per
/// voxel, a cut of a body by a plane for every voxel of the source and of the output that meet.
/// Source: ours; that a remap of cell values which keeps totals has to integrate over intersections
/// is J. K. Dukowicz, 1984.
template <class Exec>
void voxel_overlap(Exec& exec, const VoxelOverlapBody& body) {
  exec.for_each("warp/raster", body.frame.voxel_count(), body);
}

}  // namespace tetwarp

/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel is the integral over its box. The source is
/// taken as constant in the box of each of its voxels and moved with the tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/convex_part.hpp"
#include "kernels/warp/source_shares.hpp"
#include "kernels/warp/voxel_rounding.hpp"
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
  VoxelRounding output;
  std::int64_t first = 0;  ///< voxel of index 0

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
    output.store(voxel, x, sums);
  }

  /// Adds the contribution of tetrahedron t to voxel x.
  TETWARP_HD void add_tet(int t, const int* x, double* sums) const {
    const TetSetup& tet = setups[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (x[axis] < tet.begin[axis] || x[axis] >= tet.end[axis]) return;
    }
    const double scale = transforms[t].scale;
    if (!(scale > 0)) return;  // flat at rest
    double height[4];
    const BoxPlace place = place_of_box(tet, x, height);
    if (place == BoxPlace::outside) return;
    double start[3], linear[3][3];
    map_start(tet, x, start, linear);
    const auto map = make_source_map<double>(start, linear);
    if (place == BoxPlace::inside) {
      add_box(map, scale, sums);
    } else {
      add_cut_box(tet, height, map, scale, sums);
    }
  }

 private:
  /// Adds the contents of a voxel's box that is within a tetrahedron.
  TETWARP_HD_RARE void add_box(const SourceMap<double>& map, double scale, double* sums) const {
    double corner[8][3];
    for (int c = 0; c < 8; ++c) {
      const double x[3] = {(c & 1) - 0.5, (c >> 1 & 1) - 0.5, (c >> 2 & 1) - 0.5};
      set_source_position(map, x, corner[c]);
    }
    const VoxelRange range = range_of(corner, 8);
    if (is_one(range)) return add_voxel(map, range.first, scale, sums);
    add_shares(map, range, scale, sums, [&](SourceShares& shares) {
      Polygon face;
      for (const auto& loop : BoxFaces().loop) {
        face.count = 0;
        for (const int c : loop) append_corner(face, corner[c][0], corner[c][1], corner[c][2]);
        shares.add_face(face);
      }
    });
  }

  /// Adds the contents of the part of a voxel's box that is within a tetrahedron.
  TETWARP_HD_RARE void add_cut_box(const TetSetup& tet,
                                   const double* height,
                                   const SourceMap<double>& map,
                                   double scale,
                                   double* sums) const {
    ConvexPart two[2];
    const ConvexPart* const part = part_in_tet(tet, height, two[0], two[1]);
    if (part == nullptr) return;
    double corner[max_corners][3];
    for (int c = 0; c < part->corner_count; ++c) {
      set_source_position(map, part->corner[c], corner[c]);
    }
    const VoxelRange range = range_of(corner, part->corner_count);
    if (is_one(range)) return add_voxel(map, range.first, scale * volume_of(*part), sums);
    add_shares(map, range, scale, sums, [&](SourceShares& shares) {
      FaceLoops loops(*part);
      Polygon face;
      for (int e = 0; e < part->edge_count; ++e) {
        if (loops.take(part->edge[e], corner, face)) shares.add_face(face);
      }
    });
  }

  /// Adds the contents of a body with given faces.
  /// @param scale      factor on volumes of the output
  /// @param add_faces  adds them to a SourceShares
  template <class AddFaces>
  TETWARP_HD void add_shares(const SourceMap<double>& map,
                             const VoxelRange& range,
                             double scale,
                             double* sums,
                             AddFaces&& add_faces) const {
    const double volume = map_volume(map);
    if (volume == 0) return;
    const double per_volume = scale / fabs(volume);
    int begin[3], end[3];
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] = max_of(range.first[axis], -map.whole[axis]);
      end[axis] = min_of(range.last[axis] + 1, dims[axis] - map.whole[axis]);
    }
    constexpr int edge = SourceShares::edge;
    SourceShares shares;
    for (int k = begin[2]; k < end[2]; k += edge) {
      for (int j = begin[1]; j < end[1]; j += edge) {
        for (int i = begin[0]; i < end[0]; i += edge) {
          shares.set_block({i, j, k}, end);
          add_faces(shares);
          shares.for_voxels(volume < 0 ? -1 : 1, [&](const int* voxel, double share) {
            add_voxel(map, voxel, share * per_volume, sums);
          });
        }
      }
    }
  }

  /// Adds the sample of a source voxel, relative to map.whole; nothing outside of the source.
  TETWARP_HD void add_voxel(const SourceMap<double>& map,
                            const int* voxel,
                            double share,
                            double* sums) const {
    std::int64_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      at[axis] = std::int64_t{map.whole[axis]} + voxel[axis];
      if (at[axis] < 0 || at[axis] >= dims[axis]) return;
    }
    const std::int64_t from = ((at[2] * dims[1] + at[1]) * dims[0] + at[0]) * components;
    for (int c = 0; c < components; ++c) sums[c] += share * source.at(from + c);
  }
};

/// Sets voxels to the integral of the deformed source over its box, divided by the volume of a
/// voxel. The total over the output is the total of the source over the mesh at rest.
///
/// Exact but for rounding of float64 sums, added in the order of tetrahedra and of source voxels,
/// and for storing them: see VoxelRounding.
/// Where tetrahedra overlap, their contributions add up; flat ones contribute nothing.
/// @param exec  where to run
/// @param body  input and output, see VoxelOverlapBody
/// @param count  voxels to set, from body.first on
/// @pre body.components is at most max_transform_components; the public calls check it
///
/// Determinism: values agree within 2^-44 relative between back ends. Cost: about a microsecond
/// per voxel within a tetrahedron, most of it for splitting the six faces of its box at the planes
/// between source voxels.
/// Source: ours; integration over intersections in a remap that keeps totals: J. K. Dukowicz, 1984.
template <class Exec>
void voxel_overlap(Exec& exec, const VoxelOverlapBody& body, std::int64_t count) {
  exec.for_each("warp/raster", count, body);
}

}  // namespace tetwarp

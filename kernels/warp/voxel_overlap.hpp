/// @file voxel_overlap.hpp
/// Stage "raster" of a warp that keeps totals: a voxel is the integral over its box. The source is
/// taken as constant in the box of each of its voxels and moved with the tetrahedra.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/convex_part.hpp"
#include "kernels/warp/voxel_bodies.hpp"
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

/// One index = one voxel of the output, counted from `first`; any order.
struct VoxelOverlapOp {
  static constexpr int resident_blocks = 2;  ///< leaves 128 registers per thread: no spills
  View<const TetSetup> setups;
  View<const std::int32_t> tets;          ///< node indices, shape [4 * tet_count]
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
    VoxelBodies bodies;
    const std::int64_t end = end_of_cell(list, cell);
    for (std::int64_t p = list.ranges[cell].begin; p < end; ++p) {
      if (set_body(tet_of(list.pairs[p]), x, bodies.next(), sums)) bodies.add();
      if (!bodies.is_full()) continue;
      add_bodies(bodies, sums);
      bodies.clear();
    }
    if (bodies.count() > 0) add_bodies(bodies, sums);
    output.store(voxel, x, sums);
  }

  /// Sets the part of voxel x in tetrahedron t; adds its contents if they are constant.
  /// @returns whether the part remains to be added
  TETWARP_HD bool set_body(int t, const int* x, VoxelBody& body, double* sums) const {
    const TetSetup& tet = setups[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (x[axis] < tet.begin[axis] || x[axis] >= tet.end[axis]) return false;
    }
    const double scale = transforms[t].scale;
    if (!(scale > 0)) return false;  // flat at rest
    const BoxPlace place = place_of_box(tet, x, body.height);
    if (place == BoxPlace::outside) return false;
    double start[3], linear[3][3];
    map_start(tet, x, start, linear);
    body.map = make_source_map<double>(start, linear);
    const bool is_whole = place == BoxPlace::inside;
    if (add_constant(body.map, is_whole, scale, sums)) return false;
    const double volume = map_volume(body.map);
    body.tet = t;
    body.cuts = is_whole ? 0 : cuts_of(tet, body.height);
    body.met = 0;
    body.weight = scale / volume;
    return volume != 0;
  }

 private:
  /// Adds the contents of a voxel's box if the source voxels around it are all the same, and the
  /// box is within the tetrahedron or these voxels are zero.
  TETWARP_HD_RARE bool add_constant(const SourceMap<double>& map,
                                    bool is_whole,
                                    double scale,
                                    double* sums) const {
    const VoxelRange range = range_of_box(map);
    bool is_added = false;
    with_numbers(source.data, source.kind, [&](const auto* samples) {
      const auto* const constant = constant_in(range, map, samples);
      is_added = constant != nullptr && (is_whole || is_zero(constant));
      if (is_added && is_whole) add_sample(constant, scale, sums);
    });
    return is_added;
  }

  /// Adds the contents of all bodies of a voxel, together if they are in few source voxels.
  TETWARP_HD void add_bodies(VoxelBodies& bodies, double* sums) const {
    VoxelRange range;
    bodies.align(range);
    bool is_small = true;
    for (int axis = 0; axis < 3; ++axis) {
      is_small = is_small && range.last[axis] - range.first[axis] < SourceShares::edge;
    }
    if (is_small) return add_together(bodies, range, sums);
    for (int b = 0; b < bodies.count(); ++b) add_part(bodies, b, sums);
  }

  /// Adds the contents of all bodies. @param range  around them, no longer than a block
  TETWARP_HD_RARE void add_together(VoxelBodies& bodies,
                                    const VoxelRange& range,
                                    double* sums) const {
    const SourceMap<double>& map = bodies.body(0).map;
    int begin[3], size[3];
    for (int axis = 0; axis < 3; ++axis) {
      begin[axis] = max_of(range.first[axis], -map.whole[axis]);
      size[axis] = min_of(range.last[axis] + 1, dims[axis] - map.whole[axis]) - begin[axis];
      if (size[axis] <= 0) return;
    }
    bodies.meet(setups.data, tets.data);
    SourceShares shares;
    shares.set_block(begin, size);
    for (int b = 0; b < bodies.count(); ++b) {
      const PartFaces faces = bodies.faces(b, setups.data);
      for (int n = 0; n < max_part_faces; ++n) {
        SourceFace face;
        if (faces.set_face(n, face)) shares.add_face(face);
      }
    }
    add_shares(shares, range.volume, map, sums);
  }

  /// Adds the contents of a part of a voxel's box.
  TETWARP_HD_RARE void add_part(const VoxelBodies& bodies, int b, double* sums) const {
    const VoxelPart part(bodies.all_faces(b, setups.data));
    if (part.count() == 0) return;
    const SourceMap<double>& map = bodies.body(b).map;
    const VoxelRange range = part.range();
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
          const int first_voxel[3] = {i, j, k};
          const int size[3] = {min_of(end[0] - i, edge), min_of(end[1] - j, edge),
                               min_of(end[2] - k, edge)};
          shares.set_block(first_voxel, size);
          for (int f = 0; f < part.count(); ++f) shares.add_face(part.face(f));
          add_shares(shares, range.volume * fabs(bodies.body(b).weight), map, sums);
        }
      }
    }
  }

  /// Adds the samples of a block, weighted with their shares.
  /// @param volume  around the bodies, weighted
  TETWARP_HD_RARE void add_shares(const SourceShares& shares,
                                  double volume,
                                  const SourceMap<double>& map,
                                  double* sums) const {
    with_numbers(source.data, source.kind, [&](const auto* samples) {
      shares.for_voxels(least_share * volume, [&](int i, int j, int k, double share) {
        add_sample(samples + place_of(map, i, j, k), share, sums);
      });
    });
  }

  /// The sample that all source voxels of a range have in common. Null if they differ, if the range
  /// is not within the source, or too large to be worth a look.
  template <class T>
  TETWARP_HD const T* constant_in(const VoxelRange& range,
                                  const SourceMap<double>& map,
                                  const T* samples) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (range.first[axis] < -map.whole[axis] ||
          range.last[axis] >= dims[axis] - map.whole[axis] ||
          range.last[axis] - range.first[axis] >= SourceShares::edge) {
        return nullptr;
      }
    }
    const T* const one = samples + place_of(map, range.first[0], range.first[1], range.first[2]);
    for (int k = range.first[2]; k <= range.last[2]; ++k) {
      for (int j = range.first[1]; j <= range.last[1]; ++j) {
        const T* const row = samples + place_of(map, range.first[0], j, k);
        const int count = (range.last[0] - range.first[0] + 1) * components;
        for (int n = 0, c = 0; n < count; ++n) {
          if (row[n] != one[c]) return nullptr;
          c = c + 1 < components ? c + 1 : 0;
        }
      }
    }
    return one;
  }

  template <class T>
  TETWARP_HD bool is_zero(const T* sample) const {
    for (int c = 0; c < components; ++c) {
      if (sample[c] != 0) return false;
    }
    return true;
  }

  /// Place in the source of the first component of voxel (i, j, k), relative to map.whole.
  TETWARP_HD std::int64_t place_of(const SourceMap<double>& map, int i, int j, int k) const {
    const std::int64_t bar = (std::int64_t{map.whole[2]} + k) * dims[1] + (map.whole[1] + j);
    return (bar * dims[0] + (map.whole[0] + i)) * components;
  }

  template <class T>
  TETWARP_HD void add_sample(const T* sample, double share, double* sums) const {
    for (int c = 0; c < components; ++c) sums[c] += share * static_cast<double>(sample[c]);
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

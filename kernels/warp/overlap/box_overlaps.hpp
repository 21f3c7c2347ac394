/// @file box_overlaps.hpp
/// Sums over the parts of source voxels that the deformation moves into the box of an output voxel.
#pragma once
#include <cstdint>

#include "kernels/base/any_number.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/overlap/convex_part.hpp"
#include "kernels/warp/overlap/voxel_bodies.hpp"

namespace tetwarp {

/// What the stages that integrate over the boxes of voxels have in common.
///
/// `Sums` gets the parts: add(sample, components, share) with the samples of a source voxel and the
/// volume of its part, which is that of the part in the output voxel times scale_of(t). A
/// tetrahedron t whose scale is not above 0 is left out. With Sums::skips_zeros samples that are
/// zero may be left out.
struct BoxOverlaps {
  View<const TetSetup> setups;
  View<const std::int32_t> tets;       ///< node indices, shape [4 * tet_count]
  PairList list;                       ///< of widened boxes, none rejected
  View<const std::int64_t> cell_work;  ///< only keep_cell is used; size 0: no cell is kept
  OutputFrame frame;
  NumberView source;
  int dims[3];
  int components;

  /// Whether the voxels of a cell are left as they are.
  TETWARP_HD bool is_kept(std::int64_t cell) const {
    return cell_work.size > 0 && cell_work[cell] == keep_cell;
  }

  /// Adds all parts in the box of a voxel, in the order of tetrahedra and of source voxels.
  /// @param x     the voxel [frame]
  /// @param cell  that it is in
  template <class Sums>
  TETWARP_HD void add_voxel(const int* x, std::int64_t cell, Sums& sums) const {
    VoxelBodies bodies;
    const std::int64_t end = end_of_cell(list, cell);
    for (std::int64_t p = list.ranges[cell].begin; p < end; ++p) {
      if (set_body(tet_of(list.pairs[p]), x, bodies.next(), sums)) bodies.add();
      if (!bodies.is_full()) continue;
      add_bodies(bodies, sums);
      bodies.clear();
    }
    if (bodies.count() > 0) add_bodies(bodies, sums);
  }

 private:
  /// Sets the part of voxel x in tetrahedron t; adds its contents if they are constant.
  /// @returns whether the part remains to be added
  template <class Sums>
  TETWARP_HD bool set_body(int t, const int* x, VoxelBody& body, Sums& sums) const {
    const TetSetup& tet = setups[t];
    for (int axis = 0; axis < 3; ++axis) {
      if (x[axis] < tet.begin[axis] || x[axis] >= tet.end[axis]) return false;
    }
    const double scale = sums.scale_of(t);
    if (!(scale > 0)) return false;
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

  /// Adds the contents of a voxel's box if the source voxels around it are all the same, and the
  /// box is within the tetrahedron or these voxels are zero.
  template <class Sums>
  TETWARP_HD_RARE bool add_constant(const SourceMap<double>& map,
                                    bool is_whole,
                                    double scale,
                                    Sums& sums) const {
    const VoxelRange range = range_of_box(map);
    bool is_added = false;
    with_numbers(source.data, source.kind, [&](const auto* samples) {
      const auto* const constant = constant_in(range, map, samples);
      is_added = constant != nullptr && (is_whole || (Sums::skips_zeros && is_zero(constant)));
      if (is_added && is_whole) sums.add(constant, components, scale);
    });
    return is_added;
  }

  /// Adds the contents of all bodies of a voxel, together if they are in few source voxels.
  template <class Sums>
  TETWARP_HD void add_bodies(VoxelBodies& bodies, Sums& sums) const {
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
  template <class Sums>
  TETWARP_HD_RARE void add_together(VoxelBodies& bodies,
                                    const VoxelRange& range,
                                    Sums& sums) const {
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
  template <class Sums>
  TETWARP_HD_RARE void add_part(const VoxelBodies& bodies, int b, Sums& sums) const {
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
  template <class Sums>
  TETWARP_HD_RARE void add_shares(const SourceShares& shares,
                                  double volume,
                                  const SourceMap<double>& map,
                                  Sums& sums) const {
    with_numbers(source.data, source.kind, [&](const auto* samples) {
      shares.for_voxels(least_share * volume, [&](int i, int j, int k, double share) {
        sums.add(samples + place_of(map, i, j, k), components, share);
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
};

}  // namespace tetwarp

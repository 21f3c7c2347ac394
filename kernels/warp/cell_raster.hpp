/// @file cell_raster.hpp
/// Stage "raster" of the warp, common functions: finding the tetrahedron that owns a voxel of a
/// cell, and storing the voxel's samples.
///
/// Called by cell_raster.cuh (one block per cell) and by host/warp/cpu/cell_raster_cpu.cpp (one
/// thread per line of cells, row by row).
#pragma once
#include <cstdint>
#include <type_traits>

#include "kernels/base/view.hpp"
#include "kernels/warp/cell_pairs.hpp"
#include "kernels/warp/cell_planes.hpp"
#include "kernels/warp/face_sign.hpp"
#include "kernels/warp/hex_map.hpp"
#include "kernels/warp/sample/packed_source.hpp"
#include "kernels/warp/sample/volume_filter.hpp"
#include "kernels/warp/sample/volume_label.hpp"
#include "kernels/warp/sample/volume_sample.hpp"
#include "kernels/warp/tet_setup.hpp"
#include "kernels/warp/tet_transform.hpp"

namespace tetwarp {

/// Counters of the raster stage.
struct RasterCounts {
  std::int64_t covered;
  std::int64_t inside_tests;  ///< (voxel, tetrahedron) tests against four planes
  std::int64_t exact_tests;   ///< of these, undecided by float32 and repeated in integers
  std::int64_t copied;        ///< voxels that copy one sample instead of interpolating
};

/// The value of uncovered voxels. Source index of an uncovered frame voxel (i, j, k): linear *
/// (origin + (i, j, k)) + offset.
struct OutsideMap {
  bool use_source;  ///< false: the background
  bool is_copy;     ///< the grids differ by whole voxels
  double linear[3][3];
  double offset[3];
  double origin[3] = {0, 0, 0};  ///< of the frame: makes regions bit-equal to the full grid
};

constexpr std::int64_t keep_cell = -2;    ///< the output already holds this cell's result
constexpr std::int64_t sample_cell = -1;  ///< every covered voxel is sampled

/// The part of RasterJob that does not depend on the pixel type: meshes, cells, owners.
struct RasterGeometry {
  View<const TetSetup> setups;
  View<const std::int32_t> tets;
  View<const Node> nodes;
  HexView hexes;
  View<const Node> rest;  ///< in the source's index space; for hexahedra only
  View<const CellPair> pairs;
  View<const CellRange> ranges;
  std::int64_t usual_pairs = 0;  ///< about the number of pairs in use; 0: not known
  OutputFrame frame;
  OutsideMap outside;
  bool copy_whole_shifts;
  std::uint8_t* mask;             ///< may be null
  std::int32_t* tet;              ///< may be null
  RasterCounts* counts;           ///< may be null; a device adds to that of a cell's number modulo
  std::int64_t count_places = 1;  ///< this number, a power of two

  /// Per cell: keep_cell, sample_cell, or the source voxel whose samples are stored in every
  /// covered voxel. Size 0: sample_cell for all.
  View<const std::int64_t> cell_work;
  /// The cells that cell_raster_kernel() computes, the number of which is on the device; null: all.
  const std::uint32_t* listed = nullptr;
  const std::int32_t* listed_count = nullptr;
  /// Out, per cell that is not kept: number of covered voxels. Size 0: not stored.
  View<std::uint16_t> cell_covered;
  /// Per tetrahedron, see voxel_transform.hpp. Size 0: all are plain.
  View<const VoxelTransform> transforms;
  VoxelTransform outside_transform;  ///< of voxels that no tetrahedron covers
};

/// Input and output of the raster stage for one source.
template <class T>
struct RasterJob : RasterGeometry {
  SourceView<T> source;
  Filter filter;
  T background;
  Quantity reorientation;                   ///< for which the matrices of transforms were computed
  T* volume;                                ///< [k][j][i][component]
  const PackedSample<T>* packed = nullptr;  ///< the source, for a device; null: not packed
};

/// Whether voxels of tetrahedron t are transformed samples.
TETWARP_HD bool has_transform(const RasterGeometry& job, std::int64_t t) {
  return job.transforms.size > 0 && !job.transforms[t].is_plain;
}

/// Whether voxels that no tetrahedron covers are transformed samples.
TETWARP_HD bool has_outside_transform(const RasterGeometry& job) {
  return job.transforms.size > 0 && job.outside.use_source && !job.outside_transform.is_plain;
}

/// What to do with a cell, see RasterGeometry::cell_work.
TETWARP_HD std::int64_t work_of(const RasterGeometry& job, std::int64_t cell) {
  return job.cell_work.size > 0 ? job.cell_work[cell] : sample_cell;
}

/// One component of map_start().
TETWARP_HD void map_start_along(
    const TetSetup& tet, const int* corner, int row, double& start, double* linear) {
  const double from[3] = {static_cast<double>(corner[0] - tet.anchor[0]),
                          static_cast<double>(corner[1] - tet.anchor[1]),
                          static_cast<double>(corner[2] - tet.anchor[2])};
  start = tet.map[0][row] * from[0] + tet.map[1][row] * from[1] + tet.map[2][row] * from[2] +
          tet.map[3][row];
  for (int axis = 0; axis < 3; ++axis) linear[axis] = tet.map[axis][row];
}

/// Source position of a cell's first voxel under a tetrahedron's map, in float64.
/// @param start   out [source voxel]
/// @param linear  out, linear[row][a]: change of the position per voxel along axis a
TETWARP_HD void map_start(const TetSetup& tet,
                          const int* corner,
                          double* start,
                          double (*linear)[3]) {
  for (int row = 0; row < 3; ++row) map_start_along(tet, corner, row, start[row], linear[row]);
}

/// Source position of a cell's first voxel under the map of uncovered voxels.
TETWARP_HD void outside_start(const OutsideMap& map, const int* corner, double* start) {
  const double x = map.origin[0] + corner[0], y = map.origin[1] + corner[1],
               z = map.origin[2] + corner[2];
  for (int row = 0; row < 3; ++row) {
    const double* m = map.linear[row];
    start[row] = m[0] * x + m[1] * y + m[2] * z + map.offset[row];
  }
}

/// Samples a source by a filter of volume_filter.hpp or volume_label.hpp.
/// @pre the filter supports pixel type T; public calls check it
template <class T>
TETWARP_HD_RARE void sample_wide(SourceView<T> source,
                                 Filter filter,
                                 SourcePosition<ArithmeticOf<T>> at,
                                 T* out) {
  if constexpr (!std::is_floating_point_v<T>) {
    if (filter == Filter::labels) {
      out[0] = label_at(source, at);
      return;
    }
  }
  if constexpr (can_blend<T>) sample_filtered(source, filter, at, out);
}

/// store_position() for wide filters.
template <class T, class Real>
TETWARP_HD void store_wide_sample(
    const RasterJob<T>& job, Filter filter, const int* whole, const Real* x, T* out) {
  SourcePosition<ArithmeticOf<T>> at;
  bool is_inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    is_inside = is_inside && is_defined(job.source, axis, whole[axis], x[axis]);
    const Real lower = is_inside ? floor(x[axis]) : Real(0);
    at.voxel[axis] = whole[axis] + static_cast<int>(lower);
    at.fraction[axis] = static_cast<ArithmeticOf<T>>(x[axis] - lower);
  }
  if (is_inside) {
    sample_wide(job.source, filter, at, out);
  } else {
    for (int c = 0; c < job.source.components; ++c) out[c] = job.background;
  }
}

/// A voxel of a cell.
struct CellVoxel {
  const int* corner;    ///< first voxel of the cell [frame]
  int i, j, k;          ///< from there on, 0 to 7
  std::int64_t offset;  ///< position in the output array [voxel]
};

/// Stores one voxel: the source's samples at position whole + x, or the background outside it.
/// @tparam is_general  whether the filter may be wide; false saves registers
template <bool is_general, class T, class Real>
TETWARP_HD void store_position(
    const RasterJob<T>& job, Filter filter, const int* whole, const Real* x, std::int64_t voxel) {
  T* out = job.volume + voxel * job.source.components;
  if constexpr (is_general) {
    if (is_wide(filter)) return store_wide_sample(job, filter, whole, x, out);
  }
  const Tap<Real> tap = tap_of(job.source, filter, whole, x);
  for (int c = 0; c < job.source.components; ++c) {
    out[c] = tap.inside ? sample(job.source, filter, tap, c) : job.background;
  }
}

/// The same for a voxel of a cell at the position that `map` gives.
template <bool is_general, class T, class Real>
TETWARP_HD void store_sample(const RasterJob<T>& job,
                             Filter filter,
                             const SourceMap<Real>& map,
                             const CellVoxel& voxel) {
  Real x[3];
  local_position(map, voxel.i, voxel.j, voxel.k, x);
  store_position<is_general>(job, filter, map.whole, x, voxel.offset);
}

/// The map of the hexahedron that tetrahedron t belongs to. Out of line: inlined, it makes the
/// general raster kernel spill registers on sm_120.
TETWARP_HD_RARE HexMap hex_map_of(const RasterGeometry& job, std::int64_t t) {
  return make_hex_map({job.hexes, job.tets, job.nodes, job.rest}, t, job.setups[t]);
}

/// Stores frame voxel x, which a tetrahedron owns that is part of the hexahedron that `map` is for.
template <bool is_general, class T>
TETWARP_HD_RARE void store_hex_voxel(const RasterJob<T>& job,
                                     const HexMap& map,
                                     const int* x,
                                     std::int64_t voxel) {
  int whole[3];
  double at[3];
  ArithmeticOf<T> local[3];
  hex_source_position(map, x, whole, at);
  for (int axis = 0; axis < 3; ++axis) {
    whole[axis] -= job.source.origin[axis];
    local[axis] = static_cast<ArithmeticOf<T>>(at[axis]);
  }
  store_position<is_general>(job, job.filter, whole, local, voxel);
}

/// Whether the tetrahedron moved by whole voxels: its voxels copy one sample with any filter.
TETWARP_HD bool is_copied(const RasterGeometry& job, const TetSetup& tet) {
  return job.copy_whole_shifts && tet.kind == MapKind::copy;
}

/// Stores a voxel that tetrahedron t owns. Computes the map for this voxel alone: for the few
/// voxels that cannot use the map of the cell.
template <bool is_general, class T, class Real>
TETWARP_HD void store_owned(const RasterJob<T>& job, std::int64_t t, const CellVoxel& voxel) {
  const TetSetup& tet = job.setups[t];
  if constexpr (is_general) {
    if (tet.kind == MapKind::trilinear) {
      const int x[3] = {voxel.corner[0] + voxel.i, voxel.corner[1] + voxel.j,
                        voxel.corner[2] + voxel.k};
      store_hex_voxel<is_general>(job, hex_map_of(job, t), x, voxel.offset);
      return;
    }
  }
  double start[3], linear[3][3];
  map_start(tet, voxel.corner, start, linear);
  store_sample<is_general>(job, is_copied(job, tet) ? Filter::nearest : job.filter,
                           make_source_map<Real>(job.source, start, linear), voxel);
}

/// Stores the value around voxel `from`, where the source is constant.
template <class T>
TETWARP_HD void store_filled(const RasterJob<T>& job, std::int64_t from, std::int64_t voxel) {
  const int components = job.source.components;
  for (int c = 0; c < components; ++c) {
    job.volume[voxel * components + c] = constant_value(job.source, from, c);
  }
}

/// Stores a voxel that no tetrahedron covers.
template <bool is_general, class T>
TETWARP_HD void store_outside(const RasterJob<T>& job, const CellVoxel& voxel) {
  if (job.outside.use_source) {
    double start[3];
    outside_start(job.outside, voxel.corner, start);
    const bool copies = job.copy_whole_shifts && job.outside.is_copy;
    store_sample<is_general>(job, copies ? Filter::nearest : job.filter,
                             make_source_map<double>(job.source, start, job.outside.linear), voxel);
    return;
  }
  T* out = job.volume + voxel.offset * job.source.components;
  for (int c = 0; c < job.source.components; ++c) out[c] = job.background;
}

}  // namespace tetwarp

/// @file cell_class.hpp
/// Stage "raster" of the warp: cells within one tetrahedron whose samples all lie in the source.
/// Their voxels need no inside tests, no clamps and no counters: cell_interior.cuh.
#pragma once
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/volume_uniform.hpp"

namespace tetwarp {

/// How a cell of the output is computed.
enum class CellClass {
  keep,      ///< not at all: the output holds its result
  interior,  ///< by cell_interior_kernel()
  tested,    ///< by cell_tested_kernel(): samples as in interior cells, after tests
  general    ///< by cell_raster_kernel()
};

/// All that the voxels of an interior cell need.
struct alignas(16) InteriorCell {
  float base[3];        ///< as in SourceMap
  float axis[3][3];     ///< as in SourceMap
  std::int64_t source;  ///< position of the map's first voxel in the source [sample]
  std::int64_t output;  ///< position of the cell's first voxel in the output [voxel]
  std::int32_t tet;
};

/// Numbers of cells in the lists of cell_class_kernel().
struct alignas(8) CellListCounts {
  std::int32_t interior;
  std::int32_t tested;
  std::int32_t general;
};

/// Largest distance of a local position from the first voxel of a cell's map, and one more voxel
/// for the upper neighbor: maps in float32 stretch at most fourfold.
constexpr std::int64_t local_reach = 3 * static_cast<int>(steep_threshold) * (cell_edge - 1) + 2;

constexpr std::uint32_t most_tested_pairs = 16;  ///< of a tested cell: one chunk of the raster

/// Whether a job can have interior cells: one component, linear, float32 arithmetic, and offsets
/// within a cell that fit 32 bits.
template <class T>
bool has_interior_cells(const RasterJob<T>& job) {
  if constexpr (!can_blend<T> || sizeof(ArithmeticOf<T>) != 4) return false;
  const auto slice_of = [](std::int64_t width, std::int64_t height) { return width * height; };
  const std::int64_t in = slice_of(job.source.dims[0], job.source.dims[1]);
  const std::int64_t out =
      slice_of(job.frame.end[0] - job.frame.begin[0], job.frame.end[1] - job.frame.begin[1]);
  return job.source.components == 1 && job.filter == Filter::linear && job.transforms.size == 0 &&
         2 * local_reach * in < INT32_MAX && cell_edge * out < INT32_MAX;
}

/// Whether all voxels of a cell are in the output.
TETWARP_HD bool is_whole_cell(const OutputFrame& frame, const int* corner) {
  bool is_whole = true;
  for (int axis = 0; axis < 3; ++axis) {
    is_whole = is_whole && corner[axis] >= frame.begin[axis] &&
               corner[axis] + cell_edge <= frame.end[axis];
  }
  return is_whole;
}

/// Whether the neighbors of every position of a cell lie in the source.
TETWARP_HD bool maps_inside(const int* origin,
                            const int* dims,
                            const double* start,
                            const double (*linear)[3]) {
  constexpr double slack = 0.01;  // far more than the rounding of a position
  bool is_inside = true;
  for (int row = 0; row < 3; ++row) {
    double low = start[row] - origin[row] - slack, high = start[row] - origin[row] + slack;
    for (int axis = 0; axis < 3; ++axis) {
      const double span = linear[row][axis] * (cell_edge - 1);
      low += min_of(span, 0.0);
      high += max_of(span, 0.0);
    }
    is_inside = is_inside && low >= 0 && high <= dims[row] - 1;  // NaN fails too
  }
  return is_inside;
}

/// Class of a cell. @pre has_interior_cells(job)
/// @param record  out, set for interior cells
template <class T>
TETWARP_HD CellClass class_of(const RasterJob<T>& job, std::int64_t cell, InteriorCell& record) {
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return CellClass::keep;
  const CellRange range = job.ranges[cell];
  if (work != sample_cell || range.begin == range.end) return CellClass::general;
  int corner[3];
  job.frame.set_corner(static_cast<std::uint32_t>(cell), corner);  // cells are listed by 32 bits
  if (!is_whole_cell(job.frame, corner)) return CellClass::general;
  if (range.end - range.begin > most_tested_pairs) return CellClass::general;
  double start[3], linear[3][3];
  for (std::uint32_t p = range.begin; p < range.end; ++p) {
    const TetSetup& tet = job.setups[tet_of(job.pairs[p])];
    const bool is_blended =
        tet.kind == MapKind::affine || (tet.kind == MapKind::copy && !job.copy_whole_shifts);
    map_start(tet, corner, start, linear);
    if (!is_blended || !maps_inside(job.source.origin, job.source.dims, start, linear)) {
      return CellClass::general;
    }
  }
  const CellPair pair = job.pairs[range.begin];
  if (!is_accepted(pair)) {
    return job.outside.use_source ? CellClass::general : CellClass::tested;
  }
  const SourceMap<float> map = make_source_map<float>(job.source, start, linear);
  for (int row = 0; row < 3; ++row) {
    record.base[row] = map.base[row];
    for (int axis = 0; axis < 3; ++axis) record.axis[axis][row] = map.axis[axis][row];
  }
  record.source = voxel_of(job.source, map.whole[0], map.whole[1], map.whole[2]);
  record.output = job.frame.offset_of(corner[0], corner[1], corner[2]);
  record.tet = tet_of(pair);
  return CellClass::interior;
}

}  // namespace tetwarp

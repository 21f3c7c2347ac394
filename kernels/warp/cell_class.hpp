/// @file cell_class.hpp
/// Stage "raster" of the warp on a device: which cells cell_group_kernel() computes. The others are
/// left to cell_raster_kernel().
#pragma once
#include <cstddef>
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/pair_record.hpp"
#include "kernels/warp/volume_uniform.hpp"

namespace tetwarp {

/// How a cell of the output is computed.
enum class CellClass : std::int32_t {
  keep,    ///< not at all: the output holds its result
  plain,   ///< by cell_group_kernel()
  rim,     ///< the same, but a map of it leaves the source somewhere in the cell
  general  ///< by cell_raster_kernel()
};

/// Numbers of cells in the list of cell_group_kernel().
struct alignas(8) CellListCounts {
  std::int32_t general;
};

/// Bytes of the list of cells.
inline double class_list_bytes(double cells) {
  return cells * sizeof(std::uint32_t);
}

/// Largest distance of a local position from the first voxel of a cell's map, and one more voxel
/// for the upper neighbor: maps in float32 stretch at most fourfold.
constexpr std::int64_t local_reach = 3 * static_cast<int>(steep_threshold) * (cell_edge - 1) + 2;

/// Pairs of a cell that a byte numbers, zero left out.
constexpr std::uint32_t most_cell_pairs = 255;

/// Largest index of a map's first voxel for which a position's bounds are exact in float32.
constexpr double most_whole = 0x1p22;

/// Whether cell_group_kernel() can compute cells of a job: one component, linear, float32
/// arithmetic, at least two voxels along each axis, and offsets within a cell of 32 bits.
template <class T>
bool has_plain_cells(const RasterJob<T>& job) {
  if constexpr (!can_blend<T> || sizeof(ArithmeticOf<T>) != 4) return false;
  const auto slice_of = [](std::int64_t width, std::int64_t height) { return width * height; };
  const int* const dims = job.source.dims;
  const std::int64_t in = slice_of(dims[0], dims[1]);
  const std::int64_t out =
      slice_of(job.frame.end[0] - job.frame.begin[0], job.frame.end[1] - job.frame.begin[1]);
  const bool is_thick = dims[0] > 1 && dims[1] > 1 && dims[2] > 1;
  return job.source.components == 1 && job.filter == Filter::linear && job.transforms.size == 0 &&
         is_thick && 2 * local_reach * in < INT32_MAX && cell_edge * out < INT32_MAX;
}

/// Whether the positions of a cell and their upper neighbors lie in the source, along one axis.
/// @param origin, dim    of the source's window along it [voxel]
/// @param start, linear  from map_start_along()
TETWARP_HD bool maps_inside(int origin, int dim, double start, const double* linear) {
  constexpr double slack = 0.01;  // far more than the rounding of a position
  constexpr double half = 0.5 * (cell_edge - 1);
  const double middle = start - origin + half * (linear[0] + linear[1] + linear[2]);
  const double reach = half * (fabs(linear[0]) + fabs(linear[1]) + fabs(linear[2])) + slack;
  return middle - reach >= 0 && middle + reach <= dim - 1;  // NaN fails too
}

/// Whether the voxels of a tetrahedron are interpolated by a map in float32.
TETWARP_HD bool is_blended(const RasterGeometry& job, const TetSetup& tet) {
  return tet.kind == MapKind::affine || (tet.kind == MapKind::copy && !job.copy_whole_shifts);
}

/// Class of a cell if the maps of all its tetrahedra are blended and stay inside the source.
template <class T>
TETWARP_HD CellClass likely_class(const RasterJob<T>& job,
                                  std::int64_t cell,
                                  const CellRange& range) {
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return CellClass::keep;
  if (work != sample_cell || range.end - range.begin > most_cell_pairs) return CellClass::general;
  if (!job.outside.use_source) return CellClass::plain;
  const bool is_covered = range.begin < range.end && is_accepted(job.pairs[range.end - 1]);
  return is_covered ? CellClass::plain : CellClass::general;
}

}  // namespace tetwarp

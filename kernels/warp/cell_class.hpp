/// @file cell_class.hpp
/// Stage "raster" of the warp on a device: classes of cells. Cells within one tetrahedron whose
/// samples all lie in the source need no inside tests, no clamps and no counters:
/// cell_interior.cuh. Cells of several such tetrahedra need no clamps: cell_tested.cuh.
#pragma once
#include <cstddef>
#include <cstdint>

#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/pair_record.hpp"
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
  PairMap map;
  std::int64_t output;  ///< position of the cell's first voxel in the output [voxel]
};

/// A cell of class `tested`. The records of its pairs follow it in memory.
struct alignas(32) TestedCell {
  std::int64_t output;     ///< position of the cell's first voxel in the output [voxel]
  std::int32_t corner[3];  ///< the cell's first voxel [frame]
  std::uint32_t cell;
  std::int32_t pairs;  ///< 1 to most_tested_pairs
};

/// Memory for tested cells and the records of their pairs.
struct alignas(32) RecordUnit {
  std::byte bytes[32];
};

/// A tested cell and the records after it, in an array of RecordUnit.
struct alignas(8) RecordRange {
  std::uint32_t first;  ///< unit
  std::uint32_t units;
};

constexpr std::uint32_t cell_units = sizeof(TestedCell) / sizeof(RecordUnit);
constexpr std::uint32_t pair_units = sizeof(PairRecord) / sizeof(RecordUnit);

/// Numbers of cells in the lists of cell_class_kernel().
struct alignas(8) CellListCounts {
  std::int32_t interior;
  std::int32_t tested;
  std::int32_t general;
  std::uint32_t units;  ///< that tested cells and their records take
};

/// Cells by class. Each list has room for all cells.
struct CellLists {
  InteriorCell* interior;
  RecordRange* tested;
  RecordUnit* units;  ///< as many as most_units()
  std::uint32_t* general;
  CellListCounts* counts;
};

/// Largest distance of a local position from the first voxel of a cell's map, and one more voxel
/// for the upper neighbor: maps in float32 stretch at most fourfold.
constexpr std::int64_t local_reach = 3 * static_cast<int>(steep_threshold) * (cell_edge - 1) + 2;

/// Of a tested cell. With them its records are copied by one access of 16 bytes per thread.
constexpr std::uint32_t most_tested_pairs = 15;

/// Largest number of units that tested cells and their records can take.
/// @param pairs  room of the list of pairs
inline std::int64_t most_units(std::int64_t cells, std::int64_t pairs) {
  return cells * cell_units + min_of(cells * most_tested_pairs, pairs) * pair_units;
}

/// Bytes of the lists of cells by class.
/// @param pairs  as above
inline double class_list_bytes(double cells, double pairs) {
  constexpr double cell_bytes =
      sizeof(InteriorCell) + sizeof(TestedCell) + sizeof(RecordRange) + sizeof(std::uint32_t);
  return cells * cell_bytes + min_of(cells * most_tested_pairs, pairs) * sizeof(PairRecord);
}

/// Whether a job can have interior cells: one component, linear, float32 arithmetic, and offsets
/// within a cell and in the array of units that fit 32 bits.
template <class T>
bool has_interior_cells(const RasterJob<T>& job) {
  if constexpr (!can_blend<T> || sizeof(ArithmeticOf<T>) != 4) return false;
  const auto slice_of = [](std::int64_t width, std::int64_t height) { return width * height; };
  const std::int64_t in = slice_of(job.source.dims[0], job.source.dims[1]);
  const std::int64_t out =
      slice_of(job.frame.end[0] - job.frame.begin[0], job.frame.end[1] - job.frame.begin[1]);
  return job.source.components == 1 && job.filter == Filter::linear && job.transforms.size == 0 &&
         2 * local_reach * in < INT32_MAX && cell_edge * out < INT32_MAX &&
         most_units(job.frame.cell_count(), job.pairs.size) <= UINT32_MAX;
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

/// Class of a cell if the maps of all its tetrahedra are blended and stay inside; `general` else.
/// An interior cell has one pair. @pre has_interior_cells(job)
/// @param corner  the cell's first voxel [frame]
template <class T>
TETWARP_HD CellClass likely_class(const RasterJob<T>& job,
                                  std::int64_t cell,
                                  const CellRange& range,
                                  const int* corner) {
  const std::int64_t work = work_of(job, cell);
  if (work == keep_cell) return CellClass::keep;
  if (work != sample_cell || range.begin == range.end) return CellClass::general;
  if (!is_whole_cell(job.frame, corner)) return CellClass::general;
  if (range.end - range.begin > most_tested_pairs) return CellClass::general;
  if (is_accepted(job.pairs[range.begin])) return CellClass::interior;
  return job.outside.use_source ? CellClass::general : CellClass::tested;
}

}  // namespace tetwarp

/// @file cell_work.hpp
/// Stage "raster" of the warp, first part: finds cells that keep their result, and cells whose
/// covered voxels all have one value.
#pragma once
#include <cstdint>

#include "kernels/base/atomic_add.hpp"
#include "kernels/warp/cell_raster.hpp"
#include "kernels/warp/volume_uniform.hpp"

namespace tetwarp {

/// Whether the source is constant wherever the job's filter reads it for voxels of one cell in one
/// tetrahedron.
/// @returns a source voxel with the constant; -1 if there is none or the source ends there
template <class T>
TETWARP_HD std::int64_t uniform_voxel(const UniformMap& map,
                                      const RasterJob<T>& job,
                                      const TetSetup& tet,
                                      const int* corner) {
  if (tet.kind == MapKind::trilinear) return -1;
  const SourceView<T>& source = job.source;
  const int around = reach_of(job.filter);
  constexpr double slack = 0.01;  // far more than the rounding of a position
  double start[3], linear[3][3], begin[3], end[3];
  map_start(tet, corner, start, linear);
  for (int a = 0; a < 3; ++a) {
    begin[a] = max_of(tet.begin[a] - corner[a], 0);
    end[a] = min_of(tet.end[a] - corner[a], cell_edge) - 1;
  }
  int block[3], reach = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const double local = start[axis] - source.origin[axis];
    double low = local - slack, high = local + slack;
    for (int a = 0; a < 3; ++a) {
      const double at_begin = linear[axis][a] * begin[a], at_end = linear[axis][a] * end[a];
      low += min_of(at_begin, at_end);
      high += max_of(at_begin, at_end);
    }
    const int last = source.dims[axis] - 1;
    if (!(low >= -0.5 && high <= last + 0.5)) return -1;  // NaN fails too
    block[axis] = static_cast<int>(max_of(low - (around - 1), 0.0)) >> block_shift;
    const int last_block = min_of(static_cast<int>(floor(high)) + around, last) >> block_shift;
    reach = max_of(reach, last_block - block[axis] + 1);
  }
  if (map.reach[map.block_index(block[0], block[1], block[2])] < reach) return -1;
  return voxel_of(source, block[0] << block_shift, block[1] << block_shift,
                  block[2] << block_shift);
}

/// Whether two voxels have equal samples, or equal spline coefficients where the source has them.
template <class T>
TETWARP_HD bool has_constant_of(const SourceView<T>& source, std::int64_t a, std::int64_t b) {
  const int count = source.components;
  if (source.coefficients == nullptr) {
    return has_bits_of(source.data + a * count, source.data + b * count, count);
  }
  return has_bits_of(source.coefficients + a * count, source.coefficients + b * count, count);
}

/// Sets the work of a cell: `keep_cell`, `sample_cell`, or the source voxel that has the value of
/// all its covered voxels. One index = one cell; any order.
///
/// Conservative: a cell is filled only if the source is constant at every position at which the
/// cell could be sampled, so the output is the same as with sampling.
///
/// Determinism: which cells are filled may differ between back ends by the rounding of a position;
/// the output cannot. Cost: one box and one byte per pair, up to the first that is not uniform.
/// Source: ours.
template <class T>
struct CellWorkOp {
  RasterJob<T> job;    ///< its cell_work is what this sets, or size 0
  UniformMap uniform;  ///< of the job's source, or of its coefficients where it has some; empty: no
                       ///< cell is filled
  View<const std::uint8_t>
      touched;              ///< from cell_merge, shape [cell_count]; empty: all are touched
  View<std::int64_t> work;  ///< out, shape [cell_count]; empty: there is nothing to choose
  View<std::int64_t> constant_count;  ///< the number of filled cells is added to its entries; may
                                      ///< be empty

  TETWARP_HD void operator()(std::int64_t cell) const {
    if (touched.size > 0 && touched[cell] == 0) {
      work[cell] = keep_cell;
      return;
    }
    const std::int64_t voxel = uniform.reach.size > 0 ? value_of(cell) : -1;
    work[cell] = voxel < 0 ? sample_cell : voxel;
    if (voxel >= 0 && constant_count.size > 0) {
      atomic_add(&constant_count[cell % constant_count.size], 1);
    }
  }

  /// The source voxel whose samples fill all covered voxels of a cell, or -1.
  TETWARP_HD std::int64_t value_of(std::int64_t cell) const {
    int corner[3];
    job.frame.set_corner(cell, corner);
    const CellRange range = job.ranges[cell];
    std::int64_t value = -1;
    for (std::uint32_t p = range.begin; p < range.end; ++p) {
      const TetSetup& tet = job.setups[tet_of(job.pairs[p])];
      const std::int64_t voxel = uniform_voxel(uniform, job, tet, corner);
      if (voxel < 0) return -1;
      if (value >= 0 && !has_constant_of(job.source, voxel, value)) return -1;
      value = voxel;
    }
    return value;
  }
};

/// Sets the work of all cells.
template <class Exec, class T>
void cell_work(Exec& exec, const CellWorkOp<T>& op) {
  exec.for_each("warp/raster", op.work.size, op);
}

}  // namespace tetwarp

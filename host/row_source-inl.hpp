/// @file row_source-inl.hpp
/// The map of one tetrahedron over one cell, and the runs of a row that share an owner. Included
/// once per vector instruction set (the name and the toggled guard are Highway's convention).
#if defined(TETWARP_ROW_SOURCE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_SOURCE_INL
#undef TETWARP_ROW_SOURCE_INL
#else
#define TETWARP_ROW_SOURCE_INL
#endif

#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "kernels/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// How the voxels that a tetrahedron owns in a cell are sampled.
enum class RowKind {
  inner,  ///< a vector of float32 positions, none near the source's rim
  rim,    ///< the same, but positions may lie outside and neighbours are clamped
  alone   ///< voxel by voxel: copies, steep maps, float64, several components, huge sources
};

template <class T>
class RowSource {
 public:
  RowSource(const RasterJob<T>& job, const TetSetup& tet, const int* corner, int number)
      : setup_(&tet), number_(number) {
    double start[3], linear[3][3];
    map_start(tet, corner[0], corner[1], corner[2], start, linear);
    map_ = make_source_map<float>(start, linear);
    kind_ = RowKind::alone;
    if (sizeof(ArithmeticOf<T>) == 4 && tet.kind != MapKind::steep && !is_copied(job, tet)) {
      kind_ = kind_over_cell(job.source, start, linear);
    }
    for (int axis = 0; axis < 3; ++axis) corner_[axis] = corner[axis];
    if (kind_ == RowKind::alone) return;
    const bool is_along_rows = std::fabs(linear[1][0]) + std::fabs(linear[2][0]) < 0.5;
    std::int64_t origin = 0;
    for (int axis = 2; axis >= 0; --axis) {
      origin = origin * job.source.dims[axis] + map_.whole[axis];
      const int step = static_cast<int>(std::rint(linear[axis][2])) + (axis == 2);
      slice_ahead_ = slice_ahead_ * job.source.dims[axis] + (is_along_rows ? step : 0);
    }
    origin_ = static_cast<std::int32_t>(origin);
  }

  RowKind kind() const { return kind_; }
  int tet() const { return number_; }
  const TetSetup& setup() const { return *setup_; }
  const SourceMap<float>& map() const { return map_; }
  const int* corner() const { return corner_; }

  /// The sample at the map's whole part, when kind() is inner.
  std::int32_t origin() const { return origin_; }
  /// From a sample to the upper neighbours of the one in the next slice, about; 0 where rows of the
  /// output cross those of the source: eight voxels need too many lines of memory to ask ahead.
  std::int64_t slice_ahead() const { return slice_ahead_; }

 private:
  /// The kind by the box of all positions over the cell.
  static RowKind kind_over_cell(const SourceView<T>& source,
                                const double* start,
                                const double (*linear)[3]) {
    const double samples = static_cast<double>(source.dims[0]) * source.dims[1] * source.dims[2];
    if (source.components != 1 || samples > std::numeric_limits<std::int32_t>::max()) {
      return RowKind::alone;
    }
    // Eight bytes are read where two neighbours along x are wanted: up to `spare` samples more.
    constexpr int spare = 8 / sizeof(T) - 1;
    bool is_inner = true, meets_end = true;
    for (int axis = 0; axis < 3; ++axis) {
      double low = start[axis], high = start[axis];
      for (int a = 0; a < 3; ++a) {
        const double reach = (cell_edge - 1) * linear[axis][a];
        low += min_of(reach, 0.0);
        high += max_of(reach, 0.0);
      }
      const double last = source.dims[axis] - 1;
      const double slack = 0.51;  // nearest rounds up
      is_inner = is_inner && low > 0.01 && high < last - slack;
      meets_end = meets_end && high > last - slack - (axis == 0 ? spare : 0);
    }
    // Only at the last voxels of all would the read pass the end of the source.
    if (meets_end) return RowKind::alone;
    return is_inner ? RowKind::inner : RowKind::rim;
  }

  const TetSetup* setup_;
  int number_;
  RowKind kind_;
  SourceMap<float> map_;
  int corner_[3];
  std::int64_t slice_ahead_ = 0;
  std::int32_t origin_ = 0;
};

/// Voxels of one row of a cell that one source serves.
struct RowRun {
  std::int32_t source;  ///< position in the line's sources
  std::uint16_t cell;   ///< of the line
  std::uint16_t bits;   ///< voxels, 8 at most
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard

/// @file row_label_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set, like cell_raster_cpu.cpp.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/rows/row_label_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/base/pixel_dispatch.hpp"
#include "host/warp/cpu/rows/row_label-inl.hpp"
#include "host/warp/cpu/rows/row_label_writer-inl.hpp"
#include "host/warp/cpu/rows/row_scalar.hpp"
#include "host/warp/cpu/rows/row_taps-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Whether runs are written here by float32 positions, or by float64 ones for wide pixel types.
template <class T>
bool is_vectored(const SourceShape& shape, const RowSource& source) {
  if (source.setup().kind != MapKind::affine) return false;
  const double voxels = static_cast<double>(shape.dims[0]) * shape.dims[1] * shape.dims[2];
  return voxels <= std::numeric_limits<std::int32_t>::max() &&
         (sizeof(ArithmeticOf<T>) == 8 || source.kind() != RowKind::alone);
}

/// write_label_row() of one pixel type.
template <class T>
void write_row(const RasterJob<T>& job,
               const SourceShape& shape,
               const RowSource* sources,
               RowRun* runs,
               int count,
               int j,
               int k) {
  LabelWriter<T> writer(job, shape);
  RowTaps<false> inner;
  RowTaps<true> rim;
  for (RowRun *run = runs, *past = run; run < runs + count; run = past) {
    RowKind kind = RowKind::inner;
    RowRun* unit = run;  // runs of the cell in vectors; they are moved to the front
    for (; past < runs + count && past->cell == run->cell; ++past) {
      const RowSource& source = sources[past->source];
      if (!is_vectored<T>(shape, source)) {
        write_scalar_run(pixel_type_of<T>(), job, source.map(), past->bits, j, k,
                         cell_edge * past->cell);
      } else if constexpr (sizeof(ArithmeticOf<T>) == 8) {
        writer.add_wide(source, *past, j, k);
      } else {
        kind = std::max(kind, source.kind());
        std::swap(*unit++, *past);
      }
    }
    const int unit_count = static_cast<int>(unit - run);
    if constexpr (sizeof(ArithmeticOf<T>) == 4) {
      if (unit_count == 0) continue;
      if (kind == RowKind::inner) {
        writer.add_units(sources, run, unit_count, j, k, inner);
      } else {
        writer.add_units(sources, run, unit_count, j, k, rim);
      }
    }
  }
  if constexpr (sizeof(ArithmeticOf<T>) == 4) {
    writer.flush(inner);
    writer.flush(rim);
  } else {
    writer.flush_wide();
  }
  writer.finish();
}

void write_label_row(PixelType type,
                     const RasterGeometry& job,
                     const SourceShape& shape,
                     const RowSource* sources,
                     RowRun* runs,
                     int count,
                     int j,
                     int k) {
  with_pixel_type(type, [&]<class T>(T) {
    if constexpr (!std::is_floating_point_v<T>) {
      write_row(static_cast<const RasterJob<T>&>(job), shape, sources, runs, count, j, k);
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

/// @file row_transform_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set, like cell_raster_cpu.cpp.
#include <cstdint>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/rows/row_transform_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/base/pixel_dispatch.hpp"
#include "host/warp/cpu/rows/row_scalar.hpp"
#include "host/warp/cpu/rows/row_transform-inl.hpp"
#include "host/warp/cpu/rows/row_transform_batch-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// write_transform_row() of one pixel type.
template <class T>
void write_row(const RasterJob<T>& job,
               const SourceShape& shape,
               const RowSource* sources,
               const RowRun* runs,
               int count,
               int j,
               int k) {
  const double voxels = static_cast<double>(shape.dims[0]) * shape.dims[1] * shape.dims[2];
  const bool is_vectored =
      !is_wide(job.filter) && voxels <= std::numeric_limits<std::int32_t>::max();
  TransformBatch<T> batch(job, shape);
  for (const RowRun* run = runs; run < runs + count; ++run) {
    const RowSource& source = sources[run->source];
    if (!has_transform(job, source.tet())) continue;
    if (is_vectored && source.setup().kind != MapKind::trilinear) {
      batch.add(source, *run, j, k);
    } else {
      write_scalar_run(pixel_type_of<T>(), job, source.map(), run->bits, j, k,
                       cell_edge * run->cell);
    }
  }
  batch.flush();
}

void write_transform_row(PixelType type,
                         const RasterGeometry& job,
                         const SourceShape& shape,
                         const RowSource* sources,
                         const RowRun* runs,
                         int count,
                         int j,
                         int k) {
  with_pixel_type(type, [&]<class T>(T) {
    if constexpr (can_blend<T>) {
      write_row(static_cast<const RasterJob<T>&>(job), shape, sources, runs, count, j, k);
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

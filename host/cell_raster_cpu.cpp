/// @file cell_raster_cpu.cpp
/// Rasters cells row by row; compiled once per vector instruction set.
#include "host/cell_raster_cpu.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cell_raster_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/brick_grid.hpp"
#include "host/cell_rows-inl.hpp"
#include "host/pixel_dispatch.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Rasters the cells of one brick.
void raster_brick(PixelType type, const void* job, std::int64_t brick, RasterCounts& counts) {
  with_pixel_type(type, [&]<class T>(T) {
    const RasterJob<T>& typed = *static_cast<const RasterJob<T>*>(job);
    const BrickGrid bricks(typed.frame);
    CellRows<T> rows(typed, counts);
    bricks.for_each_cell(brick, [&](int ci, int cj, int ck) { rows.raster(ci, cj, ck); });
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp {

HWY_EXPORT(raster_brick);

template <class T>
void cell_raster(CpuExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  const CpuExec::Clock clock(exec, "warp/raster");
  const std::int64_t bricks = BrickGrid(job.frame).count();
  const std::int64_t batches = progress.is_wanted() ? 32 : 1;
  RasterCounts sum = {0, 0, 0, 0};
  for (std::int64_t batch = 0; batch < batches; ++batch) {
    const std::int64_t begin = bricks * batch / batches, end = bricks * (batch + 1) / batches;
    std::int64_t covered = 0, inside_tests = 0, exact_tests = 0, copied = 0;
#pragma omp parallel for schedule(dynamic) num_threads(exec.threads()) \
    reduction(+ : covered, inside_tests, exact_tests, copied)
    for (std::int64_t brick = begin; brick < end; ++brick) {
      RasterCounts counts = {0, 0, 0, 0};
      HWY_DYNAMIC_DISPATCH(raster_brick)(pixel_type_of<T>(), &job, brick, counts);
      covered += counts.covered;
      inside_tests += counts.inside_tests;
      exact_tests += counts.exact_tests;
      copied += counts.copied;
    }
    sum = {sum.covered + covered, sum.inside_tests + inside_tests, sum.exact_tests + exact_tests,
           sum.copied + copied};
    progress.report(static_cast<double>(batch + 1) / static_cast<double>(batches));
  }
  if (job.counts != nullptr) *job.counts = sum;
}

template void cell_raster(CpuExec&, const RasterJob<std::uint8_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::int8_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::uint16_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::int16_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::uint32_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::int32_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::uint64_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<std::int64_t>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<float>&, const ProgressPart&);
template void cell_raster(CpuExec&, const RasterJob<double>&, const ProgressPart&);

}  // namespace tetwarp
#endif  // HWY_ONCE

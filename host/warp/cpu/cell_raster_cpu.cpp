/// @file cell_raster_cpu.cpp
/// Implementation by Highway, compiled once per vector instruction set. Highway's convention gives
/// the -inl.hpp files that it includes their name and their toggled guard.
#include "host/warp/cpu/cell_raster_cpu.hpp"

#include <atomic>
#include <cstdint>
#include <mutex>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/warp/cpu/cell_raster_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/base/parallel.hpp"
#include "host/base/pixel_dispatch.hpp"
#include "host/warp/cpu/cell_line-inl.hpp"
#include "host/warp/cpu/line_grid.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Rasters pieces of the line grid: takes numbers from `next` until `end`.
/// @param job     a RasterJob of the pixel type
/// @param counts  of these pieces, added
void raster_pieces(PixelType type,
                   const RasterGeometry& job,
                   std::atomic<std::int64_t>& next,
                   std::int64_t end,
                   RasterCounts& counts) {
  with_pixel_type(type, [&]<class T>(T) {
    const LineGrid lines(job.frame);
    CellLine<T> line(static_cast<const RasterJob<T>&>(job), lines.longest(), counts);
    for (std::int64_t piece = next++; piece < end; piece = next++) {
      const auto [first, past] = lines.piece(piece);
      for (std::int64_t l = first; l < past; ++l) {
        const LineGrid::Line at = lines.line(l);
        line.raster(at.ci_begin, at.ci_end, at.cj, at.ck);
      }
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp {

HWY_EXPORT(raster_pieces);

void cell_raster(CpuExec& exec,
                 PixelType type,
                 const RasterGeometry& job,
                 const ProgressPart& progress) {
  const CpuExec::Clock clock(exec, "warp/raster");
  const std::int64_t pieces = LineGrid(job.frame).piece_count();
  const std::int64_t batches = progress.is_requested() ? 32 : 1;
  RasterCounts sum = {0, 0, 0, 0};
  for (std::int64_t batch = 0; batch < batches; ++batch) {
    const std::int64_t end = pieces * (batch + 1) / batches;
    std::atomic<std::int64_t> next = pieces * batch / batches;
    std::mutex adding;
    parallel_tasks(exec.threads(), exec.threads(), [&](std::int64_t) {
      RasterCounts counts = {0, 0, 0, 0};
      HWY_DYNAMIC_DISPATCH(raster_pieces)(type, job, next, end, counts);
      const std::lock_guard lock(adding);
      sum = {sum.covered + counts.covered, sum.inside_tests + counts.inside_tests,
             sum.exact_tests + counts.exact_tests, sum.copied + counts.copied};
    });
    progress.report(static_cast<double>(batch + 1) / static_cast<double>(batches));
  }
  if (job.counts != nullptr) *job.counts = sum;
}

}  // namespace tetwarp
#endif  // HWY_ONCE

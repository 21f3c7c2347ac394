/// @file cell_raster_cpu.cpp
/// Rasters cells row by row; compiled once per vector instruction set.
#include "host/cell_raster_cpu.hpp"

#include <cstdint>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "host/cell_raster_cpu.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "host/cell_line-inl.hpp"
#include "host/line_grid.hpp"
#include "host/pixel_dispatch.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Rasters lines [begin, end) of cells.
void raster_lines(
    PixelType type, const void* job, std::int64_t begin, std::int64_t end, RasterCounts& counts) {
  with_pixel_type(type, [&]<class T>(T) {
    const RasterJob<T>& typed = *static_cast<const RasterJob<T>*>(job);
    const LineGrid lines(typed.frame);
    CellLine<T> line(typed, lines.longest(), counts);
    for (std::int64_t l = begin; l < end; ++l) {
      const LineGrid::Line at = lines.line(l);
      line.raster(at.ci_begin, at.ci_end, at.cj, at.ck);
    }
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tetwarp {

HWY_EXPORT(raster_lines);

template <class T>
void cell_raster(CpuExec& exec, const RasterJob<T>& job, const ProgressPart& progress) {
  const CpuExec::Clock clock(exec, "warp/raster");
  const std::int64_t pieces = LineGrid(job.frame).piece_count();
  const std::int64_t batches = progress.is_wanted() ? 32 : 1;
  RasterCounts sum = {0, 0, 0, 0};
  for (std::int64_t batch = 0; batch < batches; ++batch) {
    const std::int64_t begin = pieces * batch / batches, end = pieces * (batch + 1) / batches;
    std::int64_t covered = 0, inside_tests = 0, exact_tests = 0, copied = 0;
#pragma omp parallel for schedule(dynamic) num_threads(exec.threads()) \
    reduction(+ : covered, inside_tests, exact_tests, copied)
    for (std::int64_t piece = begin; piece < end; ++piece) {
      RasterCounts counts = {0, 0, 0, 0};
      const auto [first, past] = LineGrid(job.frame).piece(piece);
      HWY_DYNAMIC_DISPATCH(raster_lines)(pixel_type_of<T>(), &job, first, past, counts);
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

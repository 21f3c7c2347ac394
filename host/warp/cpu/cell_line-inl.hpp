/// @file cell_line-inl.hpp
/// Raster of a line of cells along x: first the owners of its voxels, then the samples, row by row
/// over the whole line, so that the source is read in long runs. Included once per vector
/// instruction set.
#if defined(TETWARP_CELL_LINE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_CELL_LINE_INL
#undef TETWARP_CELL_LINE_INL
#else
#define TETWARP_CELL_LINE_INL
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "host/warp/cpu/line_owners-inl.hpp"
#include "host/warp/cpu/rows/row_sample-inl.hpp"
#include "host/warp/cpu/rows/row_stream-inl.hpp"
#include "kernels/warp/cell_raster.hpp"

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {

/// Rasters lines of cells of one job. Reuses its scratch memory from line to line.
template <class T>
class CellLine {
 public:
  CellLine(const RasterJob<T>& job, int longest, RasterCounts& counts)
      : job_(job),
        source_(job.source),
        owners_(job, source_, longest, counts),
        row_job_(job),
        sampler_(row_job_, source_),
        voxel_bytes_(static_cast<std::ptrdiff_t>(sizeof(T)) * job.source.components),
        stream_(sizeof(T), longest * cell_edge * voxel_bytes_, cell_edge * voxel_bytes_) {}

  /// Rasters cells [ci_begin, ci_end) of line (cj, ck), except those that are kept.
  void raster(int ci_begin, int ci_end, int cj, int ck) {
    const auto is_kept = [&](int ci) {
      return work_of(job_, job_.frame.cell_index(ci, cj, ck)) == keep_cell;
    };
    for (int ci = ci_begin; ci < ci_end;) {
      int past = ci;
      while (past < ci_end && !is_kept(past)) ++past;
      if (ci < past) raster_stretch(ci, past, cj, ck);
      ci = past + 1;
    }
  }

 private:
  /// Rasters cells [ci_begin, ci_end) of line (cj, ck), none of them kept.
  void raster_stretch(int ci_begin, int ci_end, int cj, int ck) {
    owners_.find(ci_begin, ci_end, cj, ck);
    const int components = job_.source.components;
    const CellBox first = make_cell_box(job_.frame, ci_begin, cj, ck);
    const int begin = first.begin[0];
    const int end = std::min(job_.frame.end[0], cell_edge * ci_end) - first.corner[0];
    for (int k = first.begin[2]; k < first.end[2]; ++k) {
      for (int j = first.begin[1]; j < first.end[1]; ++j) {
        const std::int64_t row =
            job_.frame.offset_of(first.corner[0], first.corner[1] + j, first.corner[2] + k);
        const int count = owners_.run_count(j, k);
        row_job_.volume =
            stream_.begin_row(job_.volume + (row + begin) * components) - begin * components;
        if (owners_.has_open()) {
          std::fill_n(row_job_.volume + begin * components, (end - begin) * components,
                      job_.background);
        }
        write_flat(first, j, k, row);
        owners_.write_covered(j, k, row);
        if (count > 0) {
          sampler_.write(owners_.sources(), owners_.hexes(), owners_.runs(j, k), count, j, k);
        }
        stream_.end_row(std::ptrdiff_t{end - begin} * voxel_bytes_);
      }
    }
    stream_.flush();
  }

  /// Writes the flat voxels of row (j, k), run by run.
  void write_flat(const CellBox& first, int j, int k, std::int64_t row) {
    for (const FlatCells& cells : owners_.flat()) {
      const int at = cell_edge * cells.first;
      if (cells.is_whole) {
        write_run(at, cell_edge * cells.past, cells.from, first, j, k, row);
        continue;
      }
      unsigned bits = cells.bits.slice[k] >> (cell_edge * j) & 0xff;
      while (bits != 0) {
        const int from = std::countr_zero(bits), past = from + std::countr_one(bits >> from);
        write_run(at + from, at + past, cells.from, first, j, k, row);
        bits &= ~0u << past;
      }
    }
  }

  /// Writes flat voxels [begin, end) of the line's row (j, k).
  /// @param from  see FlatCells
  HWY_NOINLINE void write_run(
      int begin, int end, std::int64_t from, const CellBox& first, int j, int k, std::int64_t row) {
    if (from < 0) return write_outside(begin, end, first, j, k, row);
    const int components = job_.source.components;
    T value[max_components];
    for (int c = 0; c < components; ++c) value[c] = constant_value(job_.source, from, c);
    T* out = row_job_.volume + begin * components;
    if (components == 1) {
      std::fill_n(out, end - begin, value[0]);
    } else {
      for (int voxel = begin; voxel < end; ++voxel, out += components) {
        std::copy_n(value, components, out);
      }
    }
  }

  /// Writes voxels without an owner, [begin, end) of the line's row (j, k). Their samples are the
  /// background already.
  void write_outside(int begin, int end, const CellBox& first, int j, int k, std::int64_t row) {
    owners_.write_uncovered(begin, end, row);
    if (!job_.outside.use_source) return;
    write_scalar_outside(pixel_type_of<T>(), row_job_, first.corner, begin, end, j, k);
  }

  const RasterJob<T>& job_;
  SourceShape source_;
  LineOwners owners_;
  RasterJob<T> row_job_;  ///< job_ with the current row as its volume
  RowSampler<T> sampler_;
  std::ptrdiff_t voxel_bytes_;
  RowStream stream_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
